#include <hdf5.h>

#include "app/command_line.hpp"

int main(int argc, char** argv) {
  // At exit HDF5 would complain of what it could not close in a damaged log. Nothing of ours is open by then.
  H5dont_atexit();
  return truebearing::command_line(argc, argv);
}
