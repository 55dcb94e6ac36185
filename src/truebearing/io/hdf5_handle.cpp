// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/hdf5_handle.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace truebearing {
namespace {

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

}  // namespace

InputError hdf5_error(const std::string& where, const char* action) {
  return {where, fmt::format("cannot be {}: {}", action, reason()), "a whole HDF5 file"};
}

Hdf5Handle open_hdf5_dataset(hid_t file, const std::string& dataset, const std::string& where) {
  const hid_t id = H5Dopen2(file, dataset.c_str(), H5P_DEFAULT);
  if (id < 0) throw hdf5_error(where, "read");
  return {id, H5Dclose};
}

}  // namespace truebearing
