// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/snapshot_files.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <hdf5.h>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/fuzz/bytes.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/io/hdf5_file.hpp"
#include "truebearing/io/hdf5_handle.hpp"
#include "truebearing/io/hdf5_server.hpp"
#include "truebearing/recording/snapshot_log.hpp"

namespace truebearing::testing {
namespace {

using Shape = std::vector<hsize_t>;

constexpr std::size_t kMostNumbers = 4096;  // of a dataset that is written or told

void require(bool holds, const char* broken) {
  if (!holds) throw std::logic_error(broken);
}

// As the trackers, the scores and the writer of logs rely on it.
void check_recording(const Recording& recording) {
  double last_s = -std::numeric_limits<double>::infinity();
  for (const Measurement& measurement : recording.measurements) {
    require(std::isfinite(measurement.time_s) && measurement.time_s >= last_s, "times that decrease");
    last_s = measurement.time_s;
    require(measurement.snapshots.has_value(), "no snapshots");
    const SnapshotBlock& block = *measurement.snapshots;
    require(block.sensors > 0 && block.values.size() % static_cast<std::size_t>(block.sensors) == 0 &&
                block.values.data() >= recording.snapshots->data() &&
                block.values.data() + block.values.size() <= recording.snapshots->data() + recording.snapshots->size(),
            "snapshots that are none of the file");
    require(block.interval_s > 0.0 && block.spacing_wavelengths > 0.0, "no interval or spacing");
    for (const std::complex<double>& value : block.values)
      require(!std::isinf(value.real()) && !std::isinf(value.imag()), "an infinite snapshot");
  }
  for (const Truth& target : recording.truth)
    require(target.x.size() == recording.measurements.size(), "truth of other times");
}

// What an ordinary log holds: an interval_s of 1, and as many numbers as its shape says.
struct Ordinary {
  const char* dataset;
  Shape shape;

  double number(std::size_t k) const {
    const auto place = static_cast<double>(k);
    if (shape.size() == 1) return place;                               // times
    if (shape.size() == 2) return static_cast<double>(k % 64) - 32.0;  // degrees
    return std::sin(2.0 * place);
  }
};

constexpr std::array kAttributes{"interval_s",   "spacing_wavelengths", "spacing_m",
                                 "frequency_hz", "sound_mps",           "first_time_s"};

std::array<Ordinary, 4> ordinary_log(Bytes& bytes) {
  const auto length = [&] { return hsize_t{1} + bytes.take() % 6; };
  const hsize_t intervals = length(), snapshots = length(), sensors = length(), targets = length();
  return {Ordinary{"snapshots", {intervals, snapshots, sensors, 2}},
          {"time_s", {intervals}},
          {"truth_angle_deg", {intervals, targets}},
          {"truth_rate_degps", {intervals, targets}}};
}

std::size_t size_of(const Shape& shape) {
  std::size_t size = 1;
  for (const hsize_t length : shape) {
    if (length > kMostNumbers) return length;
    size *= length;
    if (size > kMostNumbers) return size;
  }
  return size;
}

// A length as a file may say it: small, at an edge, or any.
hsize_t any_length(Bytes& bytes) {
  constexpr std::array<hsize_t, 8> kEdges{0, 1, 2, 4097, 1'000'001, hsize_t{1} << 31, hsize_t{1} << 62, ~hsize_t{0}};
  const unsigned kind = bytes.take();
  if (kind < 128) return kind % 16;
  if (kind < 248) return kEdges[kind % kEdges.size()];
  return bytes.take(8);
}

Shape altered_shape(Bytes& bytes, Shape shape) {
  switch (bytes.choice(4)) {
    case 1:
      shape.resize(bytes.take() % (H5S_MAX_RANK + 2), 1);
      break;
    case 2:
      if (!shape.empty()) shape[bytes.take() % shape.size()] = any_length(bytes);
      break;
    case 3:
      std::reverse(shape.begin(), shape.end());
      break;
    case 4:
      shape.assign(bytes.take() % 6, 0);
      for (hsize_t& length : shape) length = any_length(bytes);
      break;
    default:
      break;
  }
  return shape;
}

std::vector<double> numbers_of(Bytes& bytes, const Ordinary& ordinary, std::size_t size) {
  std::vector<double> numbers(size);
  for (std::size_t k = 0; k < size; ++k) numbers[k] = ordinary.number(k);
  if (size == 0) return numbers;
  for (unsigned altered = bytes.take() % 8; altered > 0; --altered) numbers[bytes.take(2) % size] = bytes.number();
  return numbers;
}

// ---- A file of any kind.

// Every class of types that libhdf5 has, and floats and integers that no processor has.
std::vector<hid_t> make_types() {
  std::vector<hid_t> types{H5T_IEEE_F64LE, H5T_IEEE_F64BE, H5T_IEEE_F32LE, H5T_IEEE_F32BE,     H5T_STD_I8LE,
                           H5T_STD_U8LE,   H5T_STD_I16BE,  H5T_STD_I32LE,  H5T_STD_U32BE,      H5T_STD_I64LE,
                           H5T_STD_U64BE,  H5T_STD_B16LE,  H5T_UNIX_D32LE, H5T_NATIVE_LDOUBLE, H5T_STD_REF_OBJ};
  const hid_t half = H5Tcopy(H5T_IEEE_F32LE);
  H5Tset_fields(half, 15, 10, 5, 0, 10);
  H5Tset_size(half, 2);
  H5Tset_ebias(half, 15);
  const hid_t twelve_bits = H5Tcopy(H5T_STD_I32LE);
  H5Tset_precision(twelve_bits, 12);
  H5Tset_offset(twelve_bits, 3);
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, 5);
  const hid_t long_text = H5Tcopy(H5T_C_S1);
  H5Tset_size(long_text, H5T_VARIABLE);
  const hid_t complex = H5Tcreate(H5T_COMPOUND, 16);
  H5Tinsert(complex, "r", 0, H5T_IEEE_F64LE);
  H5Tinsert(complex, "i", 8, H5T_IEEE_F64LE);
  const hsize_t two = 2;
  const hid_t named = H5Tenum_create(H5T_STD_I16LE);
  types.insert(types.end(), {half, twelve_bits, text, long_text, complex, H5Tarray_create2(H5T_IEEE_F64LE, 1, &two),
                             named, H5Tcreate(H5T_OPAQUE, 7), H5Tvlen_create(H5T_IEEE_F64LE)});
  return types;
}

hid_t any_type(Bytes& bytes) {
  static const std::vector<hid_t> types = make_types();
  return types[bytes.choice(static_cast<unsigned>(types.size()) - 1)];
}

bool is_numeric(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_FLOAT || kind == H5T_INTEGER;
}

void lay_out(Bytes& bytes, hid_t properties, const Shape& shape, hid_t space) {
  const unsigned layout = bytes.choice(8);
  Shape chunk = shape;
  for (hsize_t& length : chunk) length = std::clamp<hsize_t>(length, 1, 1 + bytes.take() % 8);
  if (layout >= 4) H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
  switch (layout) {
    case 1:
      H5Pset_layout(properties, H5D_COMPACT);
      break;
    case 2:
      H5Pset_external(properties, "/dev/null", 0, H5F_UNLIMITED);
      break;
    case 3:
      H5Pset_virtual(properties, space, "nowhere.h5", "data", space);
      break;
    case 5:
      H5Pset_deflate(properties, bytes.take() % 10);
      break;
    case 6:
      H5Pset_shuffle(properties);
      H5Pset_fletcher32(properties);
      break;
    case 7:
      H5Pset_nbit(properties);
      break;
    case 8:
      H5Pset_scaleoffset(properties, H5Z_SO_INT, bytes.take() % 32);
      break;
    default:
      break;
  }
}

void add_attribute(Bytes& bytes, hid_t data, const char* name, double usual, bool is_usual) {
  const unsigned what = bytes.choice(5);
  if (what == 1 ? is_usual : what == 0 && !is_usual) return;
  const hid_t type = any_type(bytes);
  const hsize_t length = what == 4 ? bytes.take() % 4 : 1;
  const Hdf5Handle space(what == 3   ? H5Screate(H5S_NULL)
                         : what == 4 ? H5Screate_simple(1, &length, nullptr)
                                     : H5Screate(H5S_SCALAR),
                         H5Sclose);
  const Hdf5Handle attribute(H5Acreate2(data, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const std::array<double, 4> values{what == 2 ? bytes.number() : usual, 1.0, 2.0, 3.0};
  if (!attribute.failed() && is_numeric(type)) H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, values.data());
}

void add_attributes(Bytes& bytes, hid_t data) {
  for (std::size_t n = 0; n < kAttributes.size(); ++n)
    add_attribute(bytes, data, kAttributes[n], n == 1 ? 0.5 : 1.0, n < 2);
}

void add_dataset(Bytes& bytes, hid_t file, const char* name, const Ordinary& ordinary) {
  const Shape shape = altered_shape(bytes, ordinary.shape);
  const unsigned extent = bytes.choice(2);
  const Shape unlimited(shape.size(), H5S_UNLIMITED);
  const Hdf5Handle space(extent == 1 ? H5Screate(H5S_NULL)
                                     : H5Screate_simple(static_cast<int>(shape.size()), shape.data(),
                                                        extent == 2 ? unlimited.data() : nullptr),
                         H5Sclose);
  const Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hid_t type = any_type(bytes);
  lay_out(bytes, properties.get(), shape, space.get());
  H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_LATE);
  const Hdf5Handle data(H5Dcreate2(file, name, type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                        H5Dclose);
  if (data.failed()) return;
  add_attributes(bytes, data.get());
  const bool is_left_empty = bytes.choice(1) == 1;
  const std::size_t size = extent == 1 ? 0 : size_of(shape);
  const bool is_elsewhere =
      H5Pget_external_count(properties.get()) > 0 || H5Pget_layout(properties.get()) == H5D_VIRTUAL;
  if (is_left_empty || is_elsewhere || size == 0 || size > kMostNumbers || !is_numeric(type)) return;
  const std::vector<double> numbers = numbers_of(bytes, ordinary, size);
  H5Dwrite(data.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
}

void close_group(hid_t group) {
  if (group >= 0) H5Gclose(group);
}

// Under its name stands the dataset, or what is none, or leads to one, or to none.
void add_named(Bytes& bytes, hid_t file, const Ordinary& ordinary) {
  const std::string elsewhere = fmt::format("of_{}", ordinary.dataset);
  switch (bytes.choice(7)) {
    case 1:
      return;
    case 2:
      H5Lcreate_soft(elsewhere.c_str(), file, ordinary.dataset, H5P_DEFAULT, H5P_DEFAULT);
      add_dataset(bytes, file, elsewhere.c_str(), ordinary);
      return;
    case 3:
      H5Lcreate_soft(ordinary.dataset, file, ordinary.dataset, H5P_DEFAULT, H5P_DEFAULT);
      return;
    case 4:
      H5Lcreate_external("nowhere.h5", "data", file, ordinary.dataset, H5P_DEFAULT, H5P_DEFAULT);
      return;
    case 5:
      close_group(H5Gcreate2(file, ordinary.dataset, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      return;
    case 6: {
      const Hdf5Handle type(H5Tcopy(H5T_IEEE_F64LE), H5Tclose);
      H5Tcommit2(file, ordinary.dataset, type.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
      return;
    }
    case 7:
      H5Lcreate_hard(file, "/", file, ordinary.dataset, H5P_DEFAULT, H5P_DEFAULT);
      return;
    default:
      add_dataset(bytes, file, ordinary.dataset, ordinary);
  }
}

// In place of a file of its own each input has a group in one in memory, which goes with its content when it is closed:
// a file takes longer to make than all that stands in it. After some inputs another file begins, with nothing left behind.
Hdf5Handle group_in_memory() {
  constexpr int kInputsPerFile = 256;
  static std::unique_ptr<Hdf5Handle> file;
  static int inputs = 0;
  if (inputs++ % kInputsPerFile == 0) {
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_core(access.get(), std::size_t{1} << 16, false);
    file.reset();
    file = std::make_unique<Hdf5Handle>(H5Fcreate(".made-by-a-fuzzer", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()),
                                        H5Fclose);
  }
  return {H5Gcreate_anon(file->get(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
}

// Answers from bytes that were put down.
class Buffered : public Hdf5Respondent {
 public:
  bool receive(std::span<std::byte> bytes) override {
    if (bytes.size() > answers_.size() - taken_) return false;
    std::copy_n(answers_.begin() + static_cast<std::ptrdiff_t>(taken_), bytes.size(), bytes.begin());
    taken_ += bytes.size();
    return true;
  }
  std::string end() override { return "gave up"; }

 protected:
  void put(std::span<const std::byte> bytes) { answers_.insert(answers_.end(), bytes.begin(), bytes.end()); }
  std::vector<std::byte>& answers() { return answers_; }

 private:
  std::vector<std::byte> answers_;
  std::size_t taken_ = 0;
};

// As the child, but for its process.
class Made final : public Buffered {
 public:
  explicit Made(hid_t file) : file_(file) {
    const Hdf5Answer opened;
    put(std::as_bytes(std::span(&opened, 1)));
  }
  void ask(const Hdf5Question& question) override {
    answer_hdf5_question(file_, question, [this](std::span<const std::byte> bytes) { put(bytes); });
  }

 private:
  hid_t file_;
};

// ---- A child that says what it likes.

class Told final : public Buffered {
 public:
  explicit Told(std::span<const std::uint8_t> bytes) : bytes_(bytes), log_(ordinary_log(bytes_)) { answer({}); }

  void ask(const Hdf5Question& question) override {
    if (question.size > kMostNumbers) return;  // as large as the child says: what it costs is known
    Hdf5Answer answer_to;
    const auto ordinary =
        std::find_if(log_.begin(), log_.end(), [&](const Ordinary& one) { return is(question.dataset, one.dataset); });
    answer_to.exists = 1;
    answer_to.rank = static_cast<std::uint32_t>(ordinary->shape.size());
    std::copy(ordinary->shape.begin(), ordinary->shape.end(), answer_to.lengths.begin());
    if (question.about == Hdf5Question::About::attribute) {
      answer_to.exists = is(question.attribute, kAttributes[0]) || is(question.attribute, kAttributes[1]);
      answer_to.value = 0.5;
    }
    if (!answer(answer_to) || question.about != Hdf5Question::About::values) return;
    const std::vector<double> numbers = numbers_of(bytes_, *ordinary, question.size);
    put(std::as_bytes(std::span(numbers)));
    answer({});
  }

 private:
  template <std::size_t N>
  static bool is(const std::array<char, N>& text, const char* name) {
    return std::strncmp(text.data(), name, N) == 0;
  }

  // False where nothing sensible comes behind it.
  bool answer(Hdf5Answer answer) {
    switch (bytes_.choice(7)) {
      case 1:
        answer.exists = bytes_.take();
        break;
      case 2:
        answer.failed = bytes_.take();
        answer.found.fill(static_cast<char>(bytes_.take()));
        answer.valid.fill(static_cast<char>(bytes_.take()));
        break;
      case 3:
        answer.rank = static_cast<std::uint32_t>(bytes_.take(1 + bytes_.take() % 4));
        break;
      case 4:
        answer.lengths[bytes_.take() % answer.lengths.size()] = any_length(bytes_);
        break;
      case 5:
        answer.value = bytes_.number();
        break;
      case 6:
        put(std::as_bytes(std::span(&answer, 1)).first(bytes_.take(2) % sizeof answer));
        return false;
      case 7: {
        const std::span<std::byte> all = std::as_writable_bytes(std::span(&answer, 1));
        for (unsigned altered = bytes_.take() % 16; altered > 0; --altered)
          all[bytes_.take(2) % all.size()] = static_cast<std::byte>(bytes_.take());
        break;
      }
      default:
        break;
    }
    put(std::as_bytes(std::span(&answer, 1)));
    return true;
  }

  Bytes bytes_;
  std::array<Ordinary, 4> log_;
};

}  // namespace

void read_made_snapshots(std::span<const std::uint8_t> all) {
  const Hdf5QuietErrors quiet;
  Bytes bytes(all);
  const Hdf5Handle file = group_in_memory();
  for (const Ordinary& ordinary : ordinary_log(bytes)) add_named(bytes, file.get(), ordinary);
  check_recording(read_snapshot_log(Hdf5Reader("made.h5", std::make_unique<Made>(file.get()))));
}

void read_answered_snapshots(std::span<const std::uint8_t> bytes) {
  check_recording(read_snapshot_log(Hdf5Reader("answered.h5", std::make_unique<Told>(bytes))));
}

}  // namespace truebearing::testing
