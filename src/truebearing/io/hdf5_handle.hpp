// SPDX-License-Identifier: Apache-2.0
// What both who reads and who writes with libhdf5 needs: its objects, closed when they go, and its errors in one line.
// For the .cpp files of this room and its tests alone.
#pragma once

#include <hdf5.h>
#include <string>

#include "truebearing/core/error.hpp"

namespace truebearing {

/// The library prints its errors unless told otherwise; whoever else uses it may want that, so it is put back.
class Hdf5QuietErrors {
 public:
  Hdf5QuietErrors() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Hdf5QuietErrors(const Hdf5QuietErrors&) = delete;
  Hdf5QuietErrors& operator=(const Hdf5QuietErrors&) = delete;
  ~Hdf5QuietErrors() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }
  bool failed() const { return id_ < 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// "... cannot be read: " and what the library says of its last error, to throw.
InputError hdf5_error(const std::string& where, const char* action);

/// Throws InputError where there is no such dataset.
Hdf5Handle open_hdf5_dataset(hid_t file, const std::string& dataset, const std::string& where);

}  // namespace truebearing
