// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/io/hdf5_file.hpp"
#include "truebearing/io/hdf5_server.hpp"

namespace truebearing {
namespace {

class Process final : public Hdf5Respondent {
 public:
  explicit Process(const std::string& name) : child_([&name](Channel& channel) { serve_hdf5_file(name, channel); }) {}

  void ask(const Hdf5Question& question) override { child_.channel().send(std::as_bytes(std::span(&question, 1))); }
  bool receive(std::span<std::byte> bytes) override { return child_.channel().receive(bytes); }
  std::string end() override { return child_.end(); }

 private:
  LimitedChild child_;
};

std::unique_ptr<Hdf5Respondent> process_for(const std::string& name) {
  try {
    return std::make_unique<Process>(name);
  } catch (const std::system_error& no_child) {
    throw InputError(name, fmt::format("cannot be read: {}", no_child.code().message()));
  }
}

void receive(Hdf5Respondent& respondent, std::span<std::byte> bytes, const std::string& where) {
  if (!respondent.receive(bytes))
    throw InputError(where, fmt::format("cannot be read: the HDF5 library {}", respondent.end()), "a whole HDF5 file");
}

// As far as it goes: nobody vouches for the zero at its end.
template <std::size_t N>
std::string text_of(const std::array<char, N>& text) {
  return {text.begin(), std::find(text.begin(), text.end(), '\0')};
}

Hdf5Answer receive_answer(Hdf5Respondent& respondent, const std::string& where) {
  Hdf5Answer answer;
  receive(respondent, std::as_writable_bytes(std::span(&answer, 1)), where);
  if (answer.failed != 0) throw InputError(where, text_of(answer.found), text_of(answer.valid));
  if (answer.rank > kHdf5MaxRank)
    throw InputError(where, fmt::format("is said to have {} dimensions", answer.rank),
                     fmt::format("at most {}", kHdf5MaxRank));
  return answer;
}

Hdf5Answer ask(Hdf5Respondent& respondent, const Hdf5Question& question, const std::string& where) {
  respondent.ask(question);
  return receive_answer(respondent, where);
}

Hdf5Question question(Hdf5Question::About about, const std::string& dataset, std::uint64_t size = 0) {
  Hdf5Question question{about, size, {}, {}};
  copy_hdf5_text(dataset, question.dataset);
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
  respondent_ = process_for(name_);
  receive_answer(*respondent_, name_);
}

Hdf5Reader::Hdf5Reader(std::string name, std::unique_ptr<Hdf5Respondent> respondent)
    : name_(std::move(name)), respondent_(std::move(respondent)) {
  receive_answer(*respondent_, name_);
}

Hdf5Reader::~Hdf5Reader() = default;

bool Hdf5Reader::has(const std::string& dataset) const {
  return ask(*respondent_, question(Hdf5Question::About::existence, dataset), where(dataset)).exists != 0;
}

std::vector<std::uint64_t> Hdf5Reader::shape(const std::string& dataset) const {
  const Hdf5Answer answer = ask(*respondent_, question(Hdf5Question::About::shape, dataset), where(dataset));
  return {answer.lengths.begin(), answer.lengths.begin() + answer.rank};
}

void Hdf5Reader::check_holds(const std::string& dataset, std::uint64_t size) const {
  ask(*respondent_, question(Hdf5Question::About::stored, dataset, size), where(dataset));
}

void Hdf5Reader::read(const std::string& dataset, std::span<double> values) const {
  ask(*respondent_, question(Hdf5Question::About::values, dataset, values.size()), where(dataset));
  receive(*respondent_, std::as_writable_bytes(values), where(dataset));
  receive_answer(*respondent_, where(dataset));
}

std::optional<double> Hdf5Reader::attribute(const std::string& dataset, const std::string& name) const {
  Hdf5Question about = question(Hdf5Question::About::attribute, dataset);
  copy_hdf5_text(name, about.attribute);
  const Hdf5Answer answer = ask(*respondent_, about, where(dataset) + ": " + name);
  return answer.exists != 0 ? std::optional(answer.value) : std::nullopt;
}

}  // namespace truebearing
