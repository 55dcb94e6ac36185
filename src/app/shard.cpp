// SPDX-License-Identifier: Apache-2.0
#include "app/shard.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "app/output.hpp"
#include "truebearing/core/content_hash.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/io/base64.hpp"
#include "truebearing/io/file.hpp"

namespace truebearing {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostShards = 1000000;
constexpr std::size_t kMostInput = std::size_t{1} << 30;

std::optional<std::size_t> number_of(const std::string& text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

InputError no_shard(const std::string& file) {
  return {file, "is no shard of a comparison", "a file that compare --shard wrote"};
}

Json header_json(const ShardHeader& header) {
  return {{"truebearing_shard", {header.shard.index, header.shard.count}},
          {"version", TRUEBEARING_VERSION},
          {"study", header.study},
          {"inputs", header.inputs},
          {"seed", header.seed},
          {"runs", header.runs},
          {"all", header.all},
          {"details", header.details}};
}

std::string header_line(const ShardHeader& header) {
  try {
    return header_json(header).dump() + "\n";
  } catch (const Json::type_error&) {
    throw InputError(header.study, "is a path in no UTF-8, which a shard's header is", "a folder of another name");
  }
}

std::ifstream opened(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file, "cannot be read", "a file that compare --shard wrote");
  return stream;
}

ShardHeader read_header(const std::string& file) {
  std::ifstream stream = opened(file);
  std::string line(std::size_t{1} << 16, '\0');  // a header is shorter, and another file may have no second line
  stream.read(line.data(), static_cast<std::streamsize>(line.size()));
  line.resize(static_cast<std::size_t>(stream.gcount()));
  line.resize(std::min(line.find('\n'), line.size()));
  try {
    const Json json = Json::parse(line);
    ShardHeader header;
    for (const Json* number :
         {&json.at("truebearing_shard").at(0), &json.at("truebearing_shard").at(1), &json.at("seed"), &json.at("runs")})
      if (!number->is_number_unsigned()) throw no_shard(file);
    header.shard = {json.at("truebearing_shard").at(0).get<std::size_t>(),
                    json.at("truebearing_shard").at(1).get<std::size_t>()};
    if (const auto version = json.at("version").get<std::string>(); version != TRUEBEARING_VERSION)
      throw InputError(file, "is of version " + as_shown(version), "version " TRUEBEARING_VERSION);
    header.study = json.at("study").get<std::string>();
    header.inputs = json.at("inputs").get<std::string>();
    header.seed = json.at("seed").get<std::uint64_t>();
    header.runs = json.at("runs").get<std::size_t>();
    header.all = json.at("all").get<bool>();
    header.details = json.at("details").get<bool>();
    if (header.runs > kMostRuns || header.shard.index < 1 || header.shard.index > header.shard.count ||
        header.shard.count > kMostShards || header.runs < 1)
      throw no_shard(file);
    return header;
  } catch (const nlohmann::json::exception&) {
    throw no_shard(file);
  }
}

// Both are shards of one comparison.
void check_same(const ShardHeader& a, const std::string& file_a, const ShardHeader& b, const std::string& file_b) {
  const auto differ = [&](const std::string& of_a, const std::string& of_b) {
    throw InputError(file_b, fmt::format("is of {}, and {} of {}", of_b, file_a, of_a), "shards of one comparison");
  };
  if (a.study != b.study) differ(a.study, b.study);
  if (a.seed != b.seed) differ(fmt::format("seed {}", a.seed), fmt::format("seed {}", b.seed));
  if (a.runs != b.runs) differ(fmt::format("{} runs", a.runs), fmt::format("{} runs", b.runs));
  if (a.shard.count != b.shard.count)
    differ(fmt::format("{} shards", a.shard.count), fmt::format("{} shards", b.shard.count));
  const auto with = [](bool is, const char* option) {
    return fmt::format("a comparison {} {}", is ? "with" : "without", option);
  };
  if (a.all != b.all) differ(with(a.all, "--all"), with(b.all, "--all"));
  if (a.details != b.details) differ(with(a.details, "--details"), with(b.details, "--details"));
  if (a.inputs != b.inputs)
    throw InputError(file_b, "was made with another text of the study, or of a model or scenario of it, than " + file_a,
                     "the same files for all shards");
}

}  // namespace

Shard Shard::parse(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const std::optional<std::size_t> index = number_of(text.substr(0, slash)),
                                     count = number_of(text.substr(slash + 1));
    if (index && count && *index >= 1 && *index <= *count && *count <= kMostShards) return {*index, *count};
  }
  throw InputError("--shard", "is " + as_shown(text), "I/N, part I of N, from 1/N to N/N");
}

std::string hash_of_files(const std::vector<std::filesystem::path>& files) {
  ContentHash hash;
  for (const std::filesystem::path& file : files) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) read_text_file(file, kMostInput);  // which says what is wrong with it
    hash.take(static_cast<std::uint64_t>(stream.tellg()));
    stream.seekg(0);
    std::vector<char> piece(std::size_t{1} << 20);
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())), stream.gcount() > 0)
      for (std::streamsize i = 0; i < stream.gcount(); ++i)
        hash.take(static_cast<unsigned char>(piece[static_cast<std::size_t>(i)]));
  }
  return fmt::format("{:016x}", hash.value());
}

std::string hash_of_inputs(const Study& study) {
  return hash_of_files(study.input_files());
}

void write_shard(StudyComparison& comparison, const ShardHeader& header, const std::string& output, bool quiet) {
  const std::size_t blocks = comparison.runs().blocks();
  OutputStream file(output);
  file.write(header_line(header));
  {
    ProgressLine progress(fmt::format("shard {}/{}", header.shard.index, header.shard.count), quiet);
    run_blocks(comparison.runs(), BlockRange{header.shard.first(blocks), header.shard.last(blocks)},
               progress.callback(), [&](std::size_t block, std::string_view bytes) {
                 file.write(fmt::format("[{},\"{}\"]\n", block, base64_of(bytes)));
               });
  }
  file.finish();
}

ShardHeader read_headers(std::vector<std::string>& files) {
  std::vector<std::pair<ShardHeader, std::string>> shards;
  for (const std::string& file : files) {
    shards.emplace_back(read_header(file), file);
    check_same(shards.front().first, shards.front().second, shards.back().first, file);
  }
  std::stable_sort(shards.begin(), shards.end(),
                   [](const auto& a, const auto& b) { return a.first.shard.index < b.first.shard.index; });
  const std::size_t count = shards.front().first.shard.count;
  for (std::size_t i = 0; i < shards.size(); ++i) {
    const std::size_t index = shards[i].first.shard.index;
    if (i > 0 && index == shards[i - 1].first.shard.index)
      throw InputError(shards[i].second, fmt::format("is shard {}/{}, as {} is", index, count, shards[i - 1].second),
                       "each shard once");
    if (index != i + 1) throw InputError("merge", fmt::format("shard {}/{} is missing", i + 1, count), "all shards");
    files[i] = shards[i].second;
  }
  if (shards.size() < count)
    throw InputError("merge", fmt::format("shard {}/{} is missing", shards.size() + 1, count), "all shards");
  return shards.front().first;
}

void add_shards(const std::vector<std::string>& files, const ComparisonRuns& runs, ComparisonFigures& figures) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Shard shard{i + 1, files.size()};
    std::ifstream stream = opened(files[i]);
    std::string line;
    std::getline(stream, line);  // the header
    for (std::size_t block = shard.first(runs.blocks()); block < shard.last(runs.blocks()); ++block) {
      const auto damaged = [&](const std::string& what) {
        return InputError(files[i], fmt::format("{} at block {}", what, block), "a shard as it was written");
      };
      if (!std::getline(stream, line)) throw damaged("ends");
      const std::string begin = fmt::format("[{},\"", block), end = "\"]";
      if (!line.starts_with(begin) || !line.ends_with(end) || line.size() < begin.size() + end.size())
        throw damaged("is damaged");
      const std::string_view text(line.data() + begin.size(), line.size() - begin.size() - end.size());
      const std::optional<std::string> bytes = bytes_of_base64(text);
      if (!bytes) throw damaged("is damaged");
      try {
        figures.add(block, *bytes);
      } catch (const InputError& error) {
        throw damaged("its " + error.where() + " " + error.found());
      }
    }
    if (std::getline(stream, line))
      throw InputError(files[i], "goes on behind its last block", "a shard as it was written");
  }
}

}  // namespace truebearing
