// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/hdf5_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/io/limited_child.hpp"

namespace truebearing {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t> && sizeof(hsize_t) == sizeof(std::uint64_t));

/// The library prints its errors unless told otherwise; whoever else uses it may want that, so it is put back.
class QuietErrors {
 public:
  QuietErrors() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;
  ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }
  bool failed() const { return id_ < 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

herr_t take_first(unsigned place, const H5E_error2_t* error, void* text) {
  if (place == 0 && error->desc) *static_cast<std::string*>(text) = error->desc;
  return 0;
}

/// What the library says of its last error, where it arose, in one line.
std::string reason() {
  std::string text = "HDF5 does not say why";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, &text);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

InputError error(const std::string& where, const char* action) {
  return {where, fmt::format("cannot be {}: {}", action, reason()), "a whole HDF5 file"};
}

const char* kind_of(H5T_class_t type) {
  switch (type) {
    case H5T_COMPOUND:
      return "compound values";
    case H5T_STRING:
      return "text";
    default:
      return "what are no numbers";
  }
}

void check_numbers(const std::string& where, hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind != H5T_FLOAT && kind != H5T_INTEGER)
    throw InputError(where, fmt::format("holds {}", kind_of(kind)), "floats or integers");
}

Handle open_dataset(hid_t file, const std::string& dataset, const std::string& where) {
  const hid_t id = H5Dopen2(file, dataset.c_str(), H5P_DEFAULT);
  if (id < 0) throw error(where, "read");
  return {id, H5Dclose};
}

// What the process that reads the file is asked, and what it answers.
struct Question {
  enum class About { file, existence, shape, stored, values, attribute };
  About about = About::file;
  std::uint64_t size = 0;  ///< of `stored` and `values`
  std::array<char, 256> dataset{}, attribute{};
};

struct Answer {
  bool failed = false;
  bool exists = false;
  unsigned rank = 0;
  std::array<std::uint64_t, H5S_MAX_RANK> lengths{};
  double value = 0.0;
  std::array<char, 512> found{}, valid{};  ///< where it failed
};

static_assert(std::is_trivially_copyable_v<Question> && std::is_trivially_copyable_v<Answer>);

template <std::size_t N>
void copy_text(std::string_view text, std::array<char, N>& to) {
  text.copy(to.data(), N - 1);
}

// Reads the file in a process of its own. Its errors say what was found; the other process knows where.
class FileServer {
 public:
  FileServer(std::string name, Channel& channel) : file_(open(name)), channel_(channel) {
    // From here on there is nothing to be found elsewhere: by a link, external storage, a virtual dataset.
    open_no_more_files();
  }

  void run() {
    Answer answer;
    Question question;
    while (channel_.send(std::as_bytes(std::span(&answer, 1))) &&
           channel_.receive(std::as_writable_bytes(std::span(&question, 1)))) {
      answer = {};
      try {
        answer = answer_to(question);
      } catch (const InputError& error) {
        answer = failure(error);
      }
      if (question.about == Question::About::values && !answer.failed) {
        channel_.send(std::as_bytes(std::span(&answer, 1)));
        send_values(open_dataset(question).get());
        answer = {};  // all of them were there
      }
    }
  }

  static Answer failure(const InputError& error) {
    Answer answer;
    answer.failed = true;
    copy_text(error.found(), answer.found);
    copy_text(error.valid(), answer.valid);
    return answer;
  }

 private:
  static Handle open(const std::string& name) {
    H5PLset_loading_state(0);  // no plugins
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_sec2(access.get());
    const hid_t file = H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get());
    if (file < 0) throw error(name, "opened");
    return {file, H5Fclose};
  }

  Handle open_dataset(const Question& question) const {
    return truebearing::open_dataset(file_.get(), question.dataset.data(), question.dataset.data());
  }

  Answer answer_to(const Question& question) const {
    Answer answer;
    switch (question.about) {
      case Question::About::file:
        break;
      case Question::About::existence:
        answer.exists = exists(question);
        break;
      case Question::About::shape:
        read_shape(question, answer);
        break;
      case Question::About::stored:
      case Question::About::values:
        check_stored(question);
        break;
      case Question::About::attribute:
        read_attribute(question, answer);
        break;
    }
    return answer;
  }

  bool exists(const Question& question) const {
    const htri_t exists = H5Lexists(file_.get(), question.dataset.data(), H5P_DEFAULT);
    if (exists < 0) throw error({}, "read");
    return exists > 0;
  }

  void read_shape(const Question& question, Answer& answer) const {
    const Handle data = open_dataset(question);
    const Handle space(H5Dget_space(data.get()), H5Sclose);
    const int rank = space.failed() ? -1 : H5Sget_simple_extent_ndims(space.get());
    if (rank < 0) throw error({}, "read");
    answer.rank = static_cast<unsigned>(rank);
    std::array<hsize_t, H5S_MAX_RANK> lengths{};
    H5Sget_simple_extent_dims(space.get(), lengths.data(), nullptr);
    std::copy(lengths.begin(), lengths.end(), answer.lengths.begin());
  }

  // Are so many numbers in the dataset, and in this file?
  void check_stored(const Question& question) const {
    const Handle data = open_dataset(question);
    const Handle properties(H5Dget_create_plist(data.get()), H5Pclose);
    const Handle space(H5Dget_space(data.get()), H5Sclose);
    const Handle type(H5Dget_type(data.get()), H5Tclose);
    const hssize_t size = space.failed() ? -1 : H5Sget_simple_extent_npoints(space.get());
    if (size < 0 || properties.failed() || type.failed()) throw error({}, "read");
    const auto numbers = static_cast<hsize_t>(size);
    if (numbers != question.size)
      throw InputError({}, fmt::format("holds {} numbers", numbers), fmt::format("{} of them", question.size));
    check_numbers({}, type.get());
    if (H5Pget_external_count(properties.get()) != 0 || H5Pget_layout(properties.get()) == H5D_VIRTUAL)
      throw InputError({}, "is stored in other files", "numbers in the file itself");
    // A byte of the best compression, that of zeros, stands for so many.
    constexpr hsize_t kMostCompressed = 1032;
    const hsize_t factor = H5Pget_nfilters(properties.get()) > 0 ? kMostCompressed : 1;
    if (numbers > H5Dget_storage_size(data.get()) / H5Tget_size(type.get()) * factor)
      throw InputError({}, fmt::format("has room for {} numbers, of which the file holds fewer", numbers),
                       "a dataset that was written to its end");
  }

  // Of the first dimension, as much at once as fits a buffer, so that the memory does not grow with the file.
  void send_values(hid_t data) const {
    constexpr hsize_t kBufferNumbers = hsize_t{1} << 20;
    const Handle space(H5Dget_space(data), H5Sclose);
    std::vector<hsize_t> count(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
    H5Sget_simple_extent_dims(space.get(), count.data(), nullptr);
    const hsize_t rows = count.empty() ? 1 : count[0];
    const auto size = static_cast<hsize_t>(H5Sget_simple_extent_npoints(space.get()));
    const hsize_t per_row = size / std::max<hsize_t>(rows, 1);
    const hsize_t at_once = std::max<hsize_t>(1, kBufferNumbers / std::max<hsize_t>(per_row, 1));
    std::vector<double> values;
    std::vector<hsize_t> start(count.size(), 0);
    for (hsize_t row = 0; row < rows; row += at_once) {
      const hsize_t taken = std::min(at_once, rows - row), numbers = taken * per_row;
      if (!count.empty()) {
        start[0] = row;
        count[0] = taken;
        H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
      }
      values.resize(numbers);
      const Handle memory(H5Screate_simple(1, &numbers, nullptr), H5Sclose);
      if (H5Dread(data, H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, values.data()) < 0)
        throw error({}, "read");
      channel_.send(std::as_bytes(std::span(values)));
    }
  }

  void read_attribute(const Question& question, Answer& answer) const {
    const Handle data = open_dataset(question);
    const htri_t exists = H5Aexists(data.get(), question.attribute.data());
    answer.exists = exists != 0;
    if (!answer.exists) return;
    const Handle attribute(exists < 0 ? -1 : H5Aopen(data.get(), question.attribute.data(), H5P_DEFAULT), H5Aclose);
    if (attribute.failed()) throw error({}, "read");
    const Handle space(H5Aget_space(attribute.get()), H5Sclose);
    const Handle type(H5Aget_type(attribute.get()), H5Tclose);
    check_numbers({}, type.get());
    if (const hssize_t size = H5Sget_simple_extent_npoints(space.get()); size != 1)
      throw InputError({}, fmt::format("holds {} numbers", size), "one");
    if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &answer.value) < 0) throw error({}, "read");
  }

  Handle file_;
  Channel& channel_;
};

// In the child. Where the file cannot be opened, or memory runs out, that is its last answer.
void serve(const std::string& name, Channel& channel) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Answer last;
  try {
    FileServer(name, channel).run();
    return;
  } catch (const InputError& error) {
    last = FileServer::failure(error);
  } catch (const std::bad_alloc&) {
    last = FileServer::failure({{}, "cannot be read: it takes too much memory", "a whole HDF5 file"});
  }
  channel.send(std::as_bytes(std::span(&last, 1)));
}

void receive(LimitedChild& process, std::span<std::byte> bytes, const std::string& where) {
  if (!process.channel().receive(bytes))
    throw InputError(where, fmt::format("cannot be read: the HDF5 library {}", process.end()), "a whole HDF5 file");
}

Answer receive_answer(LimitedChild& process, const std::string& where) {
  Answer answer;
  receive(process, std::as_writable_bytes(std::span(&answer, 1)), where);
  if (answer.failed) throw InputError(where, answer.found.data(), answer.valid.data());
  return answer;
}

Answer ask(LimitedChild& process, const Question& question, const std::string& where) {
  process.channel().send(std::as_bytes(std::span(&question, 1)));  // where nobody takes it, nobody answers
  return receive_answer(process, where);
}

Question question(Question::About about, const std::string& dataset, std::uint64_t size = 0) {
  Question question{about, size, {}, {}};
  copy_text(dataset, question.dataset);
  return question;
}

// At the beginning, or behind a user's block of 512 bytes, 1024, 2048, ...
bool has_signature(std::istream& file) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  std::array<char, kSignature.size()> bytes{};
  for (std::streamoff place = 0; file.seekg(place) && file.read(bytes.data(), bytes.size());
       place = std::max<std::streamoff>(512, 2 * place))
    if (std::string_view(bytes.data(), bytes.size()) == kSignature) return true;
  return false;
}

}  // namespace

bool is_hdf5_file(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return false;
  std::ifstream file(path, std::ios::binary);
  return has_signature(file);
}

Hdf5Reader::Hdf5Reader(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(path, failure);
  if (failure) throw InputError(name_, "cannot be opened: " + failure.message());
  if (!std::filesystem::is_regular_file(status)) throw InputError(name_, "is not a regular file", "an HDF5 file");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(name_, fmt::format("cannot be opened: {}", std::strerror(errno)));
  if (!has_signature(file)) throw InputError(name_, "is no HDF5 file", "one that begins with the signature of HDF5");
  try {
    process_ = std::make_unique<LimitedChild>([this](Channel& channel) { serve(name_, channel); });
  } catch (const std::system_error& no_child) {
    throw InputError(name_, fmt::format("cannot be read: {}", no_child.code().message()));
  }
  receive_answer(*process_, name_);
}

Hdf5Reader::~Hdf5Reader() = default;

bool Hdf5Reader::has(const std::string& dataset) const {
  return ask(*process_, question(Question::About::existence, dataset), where(dataset)).exists;
}

std::vector<std::uint64_t> Hdf5Reader::shape(const std::string& dataset) const {
  const Answer answer = ask(*process_, question(Question::About::shape, dataset), where(dataset));
  return {answer.lengths.begin(), answer.lengths.begin() + answer.rank};
}

void Hdf5Reader::check_holds(const std::string& dataset, std::uint64_t size) const {
  ask(*process_, question(Question::About::stored, dataset, size), where(dataset));
}

void Hdf5Reader::read(const std::string& dataset, std::span<double> values) const {
  ask(*process_, question(Question::About::values, dataset, values.size()), where(dataset));
  receive(*process_, std::as_writable_bytes(values), where(dataset));
  receive_answer(*process_, where(dataset));
}

std::optional<double> Hdf5Reader::attribute(const std::string& dataset, const std::string& name) const {
  Question about = question(Question::About::attribute, dataset);
  copy_text(name, about.attribute);
  const Answer answer = ask(*process_, about, where(dataset) + ": " + name);
  return answer.exists ? std::optional(answer.value) : std::nullopt;
}

Hdf5Writer::Hdf5Writer(std::string name) : name_(std::move(name)), file_(-1) {
  constexpr std::size_t kIncrement = std::size_t{1} << 20;
  constexpr hbool_t kOnDisk = false;
  // The library tells files in memory apart by their names.
  static std::atomic<unsigned> counter{0};
  const QuietErrors quiet;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), kIncrement, kOnDisk);
  file_ =
      H5Fcreate(fmt::format(".truebearing-in-memory-{}", counter++).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get());
  if (file_ < 0) throw error(name_, "written");
}

Hdf5Writer::~Hdf5Writer() {
  const QuietErrors quiet;
  H5Fclose(file_);
}

void Hdf5Writer::add(const std::string& dataset, const std::vector<std::uint64_t>& shape) {
  const QuietErrors quiet;
  const std::vector<hsize_t> lengths(shape.begin(), shape.end());
  const Handle space(H5Screate_simple(static_cast<int>(lengths.size()), lengths.data(), nullptr), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  const Handle data(
      H5Dcreate2(file_, dataset.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  if (data.failed()) throw error(name_, "written");
}

void Hdf5Writer::write_row(const std::string& dataset, std::uint64_t row, std::span<const double> values) {
  const QuietErrors quiet;
  const Handle data = open_dataset(file_, dataset, name_);
  const Handle space(H5Dget_space(data.get()), H5Sclose);
  std::vector<hsize_t> count(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
  H5Sget_simple_extent_dims(space.get(), count.data(), nullptr);
  std::vector<hsize_t> start(count.size(), 0);
  start[0] = row;
  count[0] = 1;
  const hsize_t size = values.size();
  const Handle from(H5Screate_simple(1, &size, nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
      H5Dwrite(data.get(), H5T_NATIVE_DOUBLE, from.get(), space.get(), H5P_DEFAULT, values.data()) < 0)
    throw error(name_, "written");
}

void Hdf5Writer::add_attribute(const std::string& dataset, const std::string& name, double value) {
  const QuietErrors quiet;
  const Handle data = open_dataset(file_, dataset, name_);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(data.get(), name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  if (attribute.failed() || H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, &value) < 0) throw error(name_, "written");
}

std::string Hdf5Writer::str() const {
  const QuietErrors quiet;
  ssize_t size = H5Fflush(file_, H5F_SCOPE_GLOBAL) < 0 ? -1 : H5Fget_file_image(file_, nullptr, 0);
  if (size < 0) throw error(name_, "written");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  size = H5Fget_file_image(file_, bytes.data(), bytes.size());
  if (size < 0) throw error(name_, "written");
  return bytes;
}

}  // namespace truebearing
