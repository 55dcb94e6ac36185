#include "truebearing/io/hdf5_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <atomic>
#include <system_error>
#include <type_traits>
#include <utility>

#include "truebearing/core/error.hpp"

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

}  // namespace

bool is_hdf5_file(const std::filesystem::path& path) {
  std::error_code unknown;
  const QuietErrors quiet;
  return std::filesystem::is_regular_file(path, unknown) && H5Fis_hdf5(path.c_str()) > 0;
}

Hdf5Reader::Hdf5Reader(const std::filesystem::path& path) : name_(path.string()), file_(-1) {
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(path, failure);
  if (failure) throw InputError(name_, "cannot be opened: " + failure.message());
  if (!std::filesystem::is_regular_file(status)) throw InputError(name_, "is not a regular file", "an HDF5 file");
  const QuietErrors quiet;
  const htri_t known = H5Fis_hdf5(path.c_str());
  if (known == 0) throw InputError(name_, "is no HDF5 file", "one that begins with the signature of HDF5");
  if (known > 0) file_ = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file_ < 0) throw error(name_, "opened");
}

Hdf5Reader::~Hdf5Reader() {
  const QuietErrors quiet;
  H5Fclose(file_);
}

bool Hdf5Reader::has(const std::string& dataset) const {
  const QuietErrors quiet;
  const htri_t exists = H5Lexists(file_, dataset.c_str(), H5P_DEFAULT);
  if (exists < 0) throw error(where(dataset), "read");
  return exists > 0;
}

std::vector<std::uint64_t> Hdf5Reader::shape(const std::string& dataset) const {
  const QuietErrors quiet;
  const Handle data = open_dataset(file_, dataset, where(dataset));
  const Handle space(H5Dget_space(data.get()), H5Sclose);
  const int rank = space.failed() ? -1 : H5Sget_simple_extent_ndims(space.get());
  if (rank < 0) throw error(where(dataset), "read");
  std::vector<hsize_t> lengths(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), lengths.data(), nullptr);
  return {lengths.begin(), lengths.end()};
}

void Hdf5Reader::read(const std::string& dataset, std::span<double> values) const {
  const QuietErrors quiet;
  const Handle data = open_dataset(file_, dataset, where(dataset));
  const Handle space(H5Dget_space(data.get()), H5Sclose);
  const hssize_t size = space.failed() ? -1 : H5Sget_simple_extent_npoints(space.get());
  if (size < 0) throw error(where(dataset), "read");
  if (static_cast<std::size_t>(size) != values.size())
    throw InputError(where(dataset), fmt::format("holds {} numbers", size), fmt::format("{} of them", values.size()));
  const Handle type(H5Dget_type(data.get()), H5Tclose);
  check_numbers(where(dataset), type.get());
  if (H5Dread(data.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw error(where(dataset), "read");
}

std::optional<double> Hdf5Reader::attribute(const std::string& dataset, const std::string& name) const {
  const QuietErrors quiet;
  const std::string place = where(dataset) + ": " + name;
  const Handle data = open_dataset(file_, dataset, where(dataset));
  const htri_t exists = H5Aexists(data.get(), name.c_str());
  if (exists == 0) return std::nullopt;
  const Handle attribute(exists < 0 ? -1 : H5Aopen(data.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  if (attribute.failed()) throw error(place, "read");
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  check_numbers(place, type.get());
  if (const hssize_t size = H5Sget_simple_extent_npoints(space.get()); size != 1)
    throw InputError(place, fmt::format("holds {} numbers", size), "one");
  double value = 0.0;
  if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &value) < 0) throw error(place, "read");
  return value;
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
