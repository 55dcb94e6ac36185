// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/hdf5_server.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <new>
#include <span>
#include <vector>

#include "truebearing/io/hdf5_handle.hpp"

namespace truebearing {
namespace {

static_assert(kHdf5MaxRank == H5S_MAX_RANK && sizeof(hsize_t) == sizeof(std::uint64_t));

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

Hdf5Answer failure(const InputError& error) {
  Hdf5Answer answer;
  answer.failed = 1;
  copy_hdf5_text(error.found(), answer.found);
  copy_hdf5_text(error.valid(), answer.valid);
  return answer;
}

std::span<const std::byte> bytes_of(const Hdf5Answer& answer) {
  return std::as_bytes(std::span(&answer, 1));
}

// Its errors say what was found; the other process knows where.
class OpenFile {
 public:
  explicit OpenFile(hid_t file) : file_(file) {}

  Hdf5Handle open_dataset(const Hdf5Question& question) const {
    return open_hdf5_dataset(file_, question.dataset.data(), question.dataset.data());
  }

  Hdf5Answer answer_to(const Hdf5Question& question) const {
    Hdf5Answer answer;
    switch (question.about) {
      case Hdf5Question::About::file:
        break;
      case Hdf5Question::About::existence:
        answer.exists = exists(question) ? 1 : 0;
        break;
      case Hdf5Question::About::shape:
        read_shape(question, answer);
        break;
      case Hdf5Question::About::stored:
      case Hdf5Question::About::values:
        check_stored(question);
        break;
      case Hdf5Question::About::attribute:
        read_attribute(question, answer);
        break;
    }
    return answer;
  }

  // Of the first dimension, as much at once as fits a buffer, so that the memory does not grow with the file.
  void send_values(hid_t data, const std::function<void(std::span<const std::byte>)>& send) const {
    constexpr hsize_t kBufferNumbers = hsize_t{1} << 20;
    const Hdf5Handle space(H5Dget_space(data), H5Sclose);
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
      const Hdf5Handle memory(H5Screate_simple(1, &numbers, nullptr), H5Sclose);
      if (H5Dread(data, H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, values.data()) < 0)
        throw hdf5_error({}, "read");
      send(std::as_bytes(std::span(values)));
    }
  }

 private:
  bool exists(const Hdf5Question& question) const {
    const htri_t exists = H5Lexists(file_, question.dataset.data(), H5P_DEFAULT);
    if (exists < 0) throw hdf5_error({}, "read");
    return exists > 0;
  }

  void read_shape(const Hdf5Question& question, Hdf5Answer& answer) const {
    const Hdf5Handle data = open_dataset(question);
    const Hdf5Handle space(H5Dget_space(data.get()), H5Sclose);
    const int rank = space.failed() ? -1 : H5Sget_simple_extent_ndims(space.get());
    if (rank < 0) throw hdf5_error({}, "read");
    answer.rank = static_cast<unsigned>(rank);
    std::array<hsize_t, H5S_MAX_RANK> lengths{};
    H5Sget_simple_extent_dims(space.get(), lengths.data(), nullptr);
    std::copy(lengths.begin(), lengths.end(), answer.lengths.begin());
  }

  // Are so many numbers in the dataset, and in this file?
  void check_stored(const Hdf5Question& question) const {
    const Hdf5Handle data = open_dataset(question);
    const Hdf5Handle properties(H5Dget_create_plist(data.get()), H5Pclose);
    const Hdf5Handle space(H5Dget_space(data.get()), H5Sclose);
    const Hdf5Handle type(H5Dget_type(data.get()), H5Tclose);
    const hssize_t size = space.failed() ? -1 : H5Sget_simple_extent_npoints(space.get());
    if (size < 0 || properties.failed() || type.failed()) throw hdf5_error({}, "read");
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

  void read_attribute(const Hdf5Question& question, Hdf5Answer& answer) const {
    const Hdf5Handle data = open_dataset(question);
    const htri_t exists = H5Aexists(data.get(), question.attribute.data());
    answer.exists = exists != 0 ? 1 : 0;
    if (exists == 0) return;
    const Hdf5Handle attribute(exists < 0 ? -1 : H5Aopen(data.get(), question.attribute.data(), H5P_DEFAULT), H5Aclose);
    if (attribute.failed()) throw hdf5_error({}, "read");
    const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose);
    const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
    check_numbers({}, type.get());
    if (const hssize_t size = H5Sget_simple_extent_npoints(space.get()); size != 1)
      throw InputError({}, fmt::format("holds {} numbers", size), "one");
    if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &answer.value) < 0) throw hdf5_error({}, "read");
  }

  hid_t file_;
};

Hdf5Handle open_file(const std::string& name) {
  H5PLset_loading_state(0);  // no plugins
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_sec2(access.get());
  const hid_t file = H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get());
  if (file < 0) throw hdf5_error(name, "opened");
  return {file, H5Fclose};
}

void serve(const std::string& name, Channel& channel) {
  const Hdf5Handle file = open_file(name);
  // From here on there is nothing to be found elsewhere: by a link, external storage, a virtual dataset.
  open_no_more_files();
  const auto send = [&channel](std::span<const std::byte> bytes) { channel.send(bytes); };
  const Hdf5Answer opened;
  channel.send(bytes_of(opened));
  for (Hdf5Question question; channel.receive(std::as_writable_bytes(std::span(&question, 1)));)
    answer_hdf5_question(file.get(), question, send);
}

}  // namespace

void answer_hdf5_question(std::int64_t id, const Hdf5Question& question,
                          const std::function<void(std::span<const std::byte>)>& send) {
  const OpenFile file(id);
  Hdf5Answer answer;
  try {
    answer = file.answer_to(question);
  } catch (const InputError& error) {
    answer = failure(error);
  }
  send(bytes_of(answer));
  if (question.about != Hdf5Question::About::values || answer.failed != 0) return;
  file.send_values(file.open_dataset(question).get(), send);
  const Hdf5Answer all_were_there;
  send(bytes_of(all_were_there));
}

void serve_hdf5_file(const std::string& name, Channel& channel) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Hdf5Answer last;
  try {
    serve(name, channel);
    return;
  } catch (const InputError& error) {
    last = failure(error);
  } catch (const std::bad_alloc&) {
    last = failure({{}, "cannot be read: it takes too much memory", "a whole HDF5 file"});
  }
  channel.send(bytes_of(last));
}

}  // namespace truebearing
