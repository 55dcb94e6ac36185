// SPDX-License-Identifier: Apache-2.0
#include "training/recurrent_training.hpp"

#include <dlfcn.h>
#include <optional>
#include <string>
#include <system_error>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

constexpr const char* kFile = "truebearing_torch.so";

// Beside the program in a build, in the library's folder of an installation; nowhere else, so that no file of the folder
// that somebody works in is ever run.
std::optional<std::filesystem::path> module_path(const std::filesystem::path& given) {
  std::error_code unknown;
  if (!given.empty())
    return std::filesystem::exists(given / kFile, unknown) ? std::optional(given / kFile) : std::nullopt;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  if (unknown) return std::nullopt;
  const std::filesystem::path folder = program.parent_path();
  for (const std::filesystem::path& candidate :
       {folder / kFile, folder.parent_path() / TRUEBEARING_LIBRARY_FOLDER / "truebearing" / kFile})
    if (std::filesystem::is_regular_file(candidate, unknown)) return std::filesystem::canonical(candidate, unknown);
  return std::nullopt;
}

}  // namespace

RecurrentModule recurrent_module(const std::filesystem::path& folder) {
  const auto path = module_path(folder);
  if (!path)
    throw InputError("training", "a recurrent network is taught by LibTorch, which this build has not",
                     "libtorch-dev when it is configured; a model that was taught runs without it");
  void* const library = dlopen(path->c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw InputError(path->string(), std::string("cannot be loaded: ") + dlerror());
  const auto* module = static_cast<const RecurrentModule*>(dlsym(library, "truebearing_recurrent_module"));
  if (!module) throw InputError(path->string(), "is no module of truebearing");
  return *module;
}

}  // namespace truebearing
