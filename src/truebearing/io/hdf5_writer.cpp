// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <fmt/format.h>
#include <type_traits>
#include <utility>

#include "truebearing/io/hdf5_file.hpp"
#include "truebearing/io/hdf5_handle.hpp"

namespace truebearing {

static_assert(std::is_same_v<hid_t, std::int64_t> && sizeof(hsize_t) == sizeof(std::uint64_t));

Hdf5Writer::Hdf5Writer(std::string name) : name_(std::move(name)), file_(-1) {
  constexpr std::size_t kIncrement = std::size_t{1} << 20;
  constexpr hbool_t kOnDisk = false;
  // The library tells files in memory apart by their names.
  static std::atomic<unsigned> counter{0};
  const Hdf5QuietErrors quiet;
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), kIncrement, kOnDisk);
  file_ =
      H5Fcreate(fmt::format(".truebearing-in-memory-{}", counter++).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get());
  if (file_ < 0) throw hdf5_error(name_, "written");
}

Hdf5Writer::~Hdf5Writer() {
  const Hdf5QuietErrors quiet;
  H5Fclose(file_);
}

void Hdf5Writer::add(const std::string& dataset, const std::vector<std::uint64_t>& shape) {
  const Hdf5QuietErrors quiet;
  const std::vector<hsize_t> lengths(shape.begin(), shape.end());
  const Hdf5Handle space(H5Screate_simple(static_cast<int>(lengths.size()), lengths.data(), nullptr), H5Sclose);
  const Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  const Hdf5Handle data(
      H5Dcreate2(file_, dataset.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  if (data.failed()) throw hdf5_error(name_, "written");
}

void Hdf5Writer::write_row(const std::string& dataset, std::uint64_t row, std::span<const double> values) {
  const Hdf5QuietErrors quiet;
  const Hdf5Handle data = open_hdf5_dataset(file_, dataset, name_);
  const Hdf5Handle space(H5Dget_space(data.get()), H5Sclose);
  std::vector<hsize_t> count(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
  H5Sget_simple_extent_dims(space.get(), count.data(), nullptr);
  std::vector<hsize_t> start(count.size(), 0);
  start[0] = row;
  count[0] = 1;
  const hsize_t size = values.size();
  const Hdf5Handle from(H5Screate_simple(1, &size, nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
      H5Dwrite(data.get(), H5T_NATIVE_DOUBLE, from.get(), space.get(), H5P_DEFAULT, values.data()) < 0)
    throw hdf5_error(name_, "written");
}

void Hdf5Writer::add_attribute(const std::string& dataset, const std::string& name, double value) {
  const Hdf5QuietErrors quiet;
  const Hdf5Handle data = open_hdf5_dataset(file_, dataset, name_);
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle attribute(
      H5Acreate2(data.get(), name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (attribute.failed() || H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, &value) < 0)
    throw hdf5_error(name_, "written");
}

std::string Hdf5Writer::str() const {
  const Hdf5QuietErrors quiet;
  ssize_t size = H5Fflush(file_, H5F_SCOPE_GLOBAL) < 0 ? -1 : H5Fget_file_image(file_, nullptr, 0);
  if (size < 0) throw hdf5_error(name_, "written");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  size = H5Fget_file_image(file_, bytes.data(), bytes.size());
  if (size < 0) throw hdf5_error(name_, "written");
  return bytes;
}

}  // namespace truebearing
