// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/safetensors.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <vector>

#include "truebearing/core/error.hpp"
#include "truebearing/io/json_file.hpp"

namespace truebearing {
namespace {

static_assert(std::endian::native == std::endian::little, "the numbers are copied as they stand");

constexpr std::size_t kLengthBytes = 8;

struct Place {
  std::string name;
  Eigen::Index rows = 1, columns = 1;
  bool vector = false;
  std::size_t begin = 0, end = 0;  // bytes behind the header
};

std::size_t count_at(const nlohmann::json& value, const std::string& where) {
  if (!value.is_number_unsigned()) throw InputError(where, "holds " + value.dump().substr(0, 40), "a count");
  return value.get<std::size_t>();
}

Place place_of(const nlohmann::json& entry, const std::string& name, const std::string& where,
               const TensorLimits& limits) {
  Place place{.name = name};
  if (!entry.is_object() || !entry.contains("dtype") || !entry.contains("shape") || !entry.contains("data_offsets"))
    throw InputError(where, "is no tensor", "dtype, shape and data_offsets");
  if (entry["dtype"] != "F32")
    throw InputError(where + ".dtype", "is " + entry["dtype"].dump().substr(0, 40), "\"F32\"");
  const nlohmann::json &shape = entry["shape"], &offsets = entry["data_offsets"];
  if (!shape.is_array() || shape.empty() || shape.size() > 2)
    throw InputError(where + ".shape", "is " + shape.dump().substr(0, 40), "one or two counts");
  if (!offsets.is_array() || offsets.size() != 2)
    throw InputError(where + ".data_offsets", "is " + offsets.dump().substr(0, 40), "a begin and an end");
  std::size_t counts[2] = {1, 1};
  for (std::size_t i = 0; i < shape.size(); ++i) {
    counts[i] = count_at(shape[i], where + ".shape");
    if (counts[i] < 1 || counts[i] > static_cast<std::size_t>(limits.max_rows))
      throw InputError(where + ".shape", fmt::format("holds {}", counts[i]), fmt::format("1 to {}", limits.max_rows));
  }
  place.vector = shape.size() == 1;
  place.rows = static_cast<Eigen::Index>(counts[0]);
  place.columns = static_cast<Eigen::Index>(counts[1]);
  place.begin = count_at(offsets[0], where + ".data_offsets");
  place.end = count_at(offsets[1], where + ".data_offsets");
  if (place.end < place.begin || place.end - place.begin != counts[0] * counts[1] * sizeof(float))
    throw InputError(where + ".data_offsets", fmt::format("are {} to {}", place.begin, place.end),
                     fmt::format("{} bytes for its shape", counts[0] * counts[1] * sizeof(float)));
  return place;
}

}  // namespace

Tensors parse_safetensors(std::string_view bytes, const std::string& name, TensorLimits limits) {
  const auto error = [&](const std::string& found, const std::string& valid) { return InputError(name, found, valid); };
  if (bytes.size() > limits.max_bytes)
    throw error(fmt::format("has {} bytes", bytes.size()), fmt::format("at most {}", limits.max_bytes));
  std::uint64_t header_bytes = 0;
  if (bytes.size() < kLengthBytes) throw error("is no safetensors file", "a header behind its length");
  std::memcpy(&header_bytes, bytes.data(), kLengthBytes);
  if (header_bytes > bytes.size() - kLengthBytes)
    throw error("is no safetensors file, or is cut off", "a header behind its length");
  const nlohmann::json header = parse_json(bytes.substr(kLengthBytes, header_bytes), name);
  if (!header.is_object()) throw error("has a header that is no object", "{ ... }");
  const std::string_view data = bytes.substr(kLengthBytes + header_bytes);

  std::vector<Place> places;
  for (const auto& [key, entry] : header.items())
    if (key != "__metadata__") places.push_back(place_of(entry, key, name + ": " + key, limits));
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.begin < b.begin; });
  std::size_t next = 0;
  for (const Place& place : places) {
    if (place.begin != next || place.end > data.size())
      throw InputError(name + ": " + place.name + ".data_offsets", fmt::format("are {} to {}", place.begin, place.end),
                       fmt::format("one array behind the other, from {} within {} bytes", next, data.size()));
    next = place.end;
  }
  if (next != data.size()) throw error(fmt::format("holds {} bytes of no tensor", data.size() - next), "none");

  Tensors tensors;
  for (const Place& place : places) {
    using ByRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    ByRows values(place.rows, place.columns);
    std::memcpy(values.data(), data.data() + place.begin, place.end - place.begin);
    if (!values.allFinite()) throw InputError(name + ": " + place.name, "holds a number that is not finite");
    tensors[place.name] = {values, place.vector};
  }
  return tensors;
}

std::string safetensors_bytes(const Tensors& tensors) {
  nlohmann::ordered_json header = nlohmann::ordered_json::object();
  std::string data;
  for (const auto& [name, tensor] : tensors) {
    const std::size_t begin = data.size();
    using ByRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const ByRows values = tensor.values;
    data.append(reinterpret_cast<const char*>(values.data()), static_cast<std::size_t>(values.size()) * sizeof(float));
    nlohmann::ordered_json shape = nlohmann::ordered_json::array({values.rows()});
    if (!tensor.vector) shape.push_back(values.cols());
    header[name] = {{"dtype", "F32"}, {"shape", shape}, {"data_offsets", {begin, data.size()}}};
  }
  std::string text = header.dump();
  text.append((kLengthBytes - text.size() % kLengthBytes) % kLengthBytes, ' ');  // numbers begin at their own alignment
  const std::uint64_t header_bytes = text.size();
  std::string bytes(kLengthBytes, '\0');
  std::memcpy(bytes.data(), &header_bytes, kLengthBytes);
  return bytes + text + data;
}

}  // namespace truebearing
