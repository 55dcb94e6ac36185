// SPDX-License-Identifier: Apache-2.0
#include "app/ranks_of_mpirun.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <fmt/format.h>
#include <string>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "app/output.hpp"
#include "truebearing/core/error.hpp"
#include "mpi/mpi_module.hpp"

namespace truebearing {
namespace {

constexpr const char* kMpiFile = "truebearing_mpi.so";

// As mpirun of Open MPI tells whom it starts.
bool has_others() {
  const char* const size = std::getenv("OMPI_COMM_WORLD_SIZE");
  return size && std::strtol(size, nullptr, 10) > 1;
}

// Beside the program in a build, in the library's folder of an installation; nowhere else.
std::filesystem::path module_file() {
  std::error_code unknown;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  const std::filesystem::path folder = program.parent_path();
  for (const std::filesystem::path& candidate :
       {folder / kMpiFile, folder.parent_path() / TRUEBEARING_LIBRARY_FOLDER / "truebearing" / kMpiFile})
    if (std::filesystem::is_regular_file(candidate, unknown)) return candidate;
  throw InputError("mpirun", "has started several processes, and this build of truebearing knows nothing of MPI",
                   "libopenmpi-dev, and cmake -DTRUEBEARING_MPI=ON");
}

std::unique_ptr<Ranks> join() {
  const std::filesystem::path file = module_file();
  // Open MPI loads parts of its own, which look for what is loaded here.
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (!library) throw InputError(file.string(), std::string("cannot be loaded: ") + dlerror());
  const auto* module = static_cast<const MpiModule*>(dlsym(library, "truebearing_mpi_module"));
  if (!module) throw InputError(file.string(), "is no module of truebearing");
  return module->join();
}

// mpirun ends the others where one is gone. It does not say why: one that failed has said so itself.
void tell_of_the_end(int) {
  constexpr std::string_view kText =
      "truebearing: mpirun: all ranks end, as one failed, was killed or lost its machine, or as mpirun was told to; "
      "what was not done by then is not written\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kText.data(), kText.size());
  ::_exit(1);
}

}  // namespace

void with_ranks(const std::function<void(Ranks* ranks)>& work) {
  if (!has_others()) return work(nullptr);
  const std::unique_ptr<Ranks> ranks = join();
  if (ranks->rank() == 0) std::signal(SIGTERM, tell_of_the_end);
  try {
    work(ranks.get());
  } catch (const std::exception& error) {
    // What is wrong at all of them is told once, by the first, whose end is the others' too.
    if (ranks->rank() != 0) std::this_thread::sleep_for(std::chrono::seconds(4));
    say(fmt::format("truebearing: {}{}", ranks->rank() == 0 ? "" : fmt::format("rank {}: ", ranks->rank()),
                    error.what()));
    std::signal(SIGTERM, SIG_DFL);
    ranks->abort();
  }
  std::signal(SIGTERM, SIG_DFL);  // all is done
  ranks->leave();
}

}  // namespace truebearing
