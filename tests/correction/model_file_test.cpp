// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tests/support/correction_models.hpp"
#include "tests/support/error_message.hpp"

namespace truebearing::model_file_test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

CorrectionModel model_to_save() {
  RandomStream random({.seed = 4}, StreamId::test);
  CorrectionModel model = testing::line_model(testing::radar_features(), testing::random_parameters(random, 4, 5, 2),
                                              "plain", "tuned", "wide");
  model.design.features.back() = {.kind = FeatureKind::innovation_average, .companion = "wide", .alpha = 1.0 / 3.0};
  model.gate = testing::box(4, -1.0 / 3.0, 1e-300, 2.5);
  model.rules().inflation =
      Eigen::VectorXd::NullaryExpr(5, [&] { return std::pow(10.0, random.uniform(-300.0, 300.0)); });
  model.rules().usage = Eigen::VectorXd::NullaryExpr(5, [&] { return random.uniform(); });
  model.rules().local_mean = Eigen::MatrixXd::NullaryExpr(5, 2, [&] { return 1e3 * random.normal(); });
  model.trackers["plain"] = "kalman {start = {kind = \"prior\"}} \\ \t \u00e9";
  model.provenance = {{"study", "\"quoted\"\nand broken"}, {"seed", "1"}};
  return model;
}

std::string refusal(const std::string& text) {
  return error_message([&] { parse_model(text, "model.json"); });
}

std::string refusal_of(const std::function<void(json&)>& change) {
  json altered = json::parse(model_text(model_to_save()));
  change(altered);
  return refusal(altered.dump());
}

TEST(ModelFile, SaveLoadSaveIsByteIdentical) {
  const std::string saved = model_text(model_to_save());
  const CorrectionModel loaded = parse_model(saved, "model.json");
  EXPECT_EQ(model_text(loaded), saved);
  const CorrectionModel original = model_to_save();
  EXPECT_EQ(loaded.rules().network.parameters(), original.rules().network.parameters());
  EXPECT_EQ(loaded.gate, original.gate);
  EXPECT_EQ(loaded.design.features, original.design.features);
  EXPECT_EQ(loaded.trackers, original.trackers);
  EXPECT_EQ(loaded.rules().inflation, original.rules().inflation);
}

TEST(ModelFile, FeaturesOfANeighbourAreKept) {
  CorrectionModel model = model_to_save();
  model.design.features[0] = {.kind = FeatureKind::neighbour_closeness};
  model.design.features[1] = {.kind = FeatureKind::neighbour_difference, .component = "velocity_mps", .scale = 0.1};
  model.design.features[2] = {
      .kind = FeatureKind::neighbour_difference, .component = "position_m", .scale_is_sigma = true};
  const std::string saved = model_text(model);
  const CorrectionModel loaded = parse_model(saved, "model.json");
  EXPECT_EQ(loaded.design.features, model.design.features);
  EXPECT_EQ(model_text(loaded), saved);
}

TEST(ModelFile, WithoutGateItIsByteIdenticalToo) {
  CorrectionModel model = model_to_save();
  model.gate.reset();
  const std::string saved = model_text(model);
  const CorrectionModel loaded = parse_model(saved, "model.json");
  EXPECT_EQ(model_text(loaded), saved);
  EXPECT_FALSE(loaded.gate);
}

// Files of version 1 held the bounds: they are read, and what they were validated with is remembered as text.
TEST(ModelFile, FirstVersionIsReadAndItsBoundsAreRemembered) {
  json first = json::parse(model_text(model_to_save()));
  first["version"] = 1;
  first["kappa"] = nullptr;
  CorrectionModel loaded = parse_model(first.dump(), "model.json");
  EXPECT_EQ(loaded.provenance.at("bounds"), "kappa inf, gate, no referee");
  first["kappa"] = 4.0;
  first["gate"] = nullptr;
  first["referee"] = {{"alpha", 0.03}, {"tolerance", 1.05}, {"edge", 0.025}};
  EXPECT_EQ(parse_model(first.dump(), "model.json").provenance.at("bounds"),
            "kappa 4, no gate, referee of alpha 0.03, tolerance 1.05, edge 0.025");
  loaded.provenance.erase("bounds");
  EXPECT_EQ(model_text(loaded), model_text(model_to_save())) << "and nothing else differs";
  first.erase("kappa");
  EXPECT_THAT(refusal(first.dump()), AllOf(HasSubstr("kappa"), HasSubstr("missing")));
  first["version"] = 2;
  EXPECT_THAT(refusal(first.dump()), HasSubstr("referee")) << "which is the study's now";
}

TEST(ModelFile, GateThatAllowsAnyDisagreementIsByteIdenticalToo) {
  CorrectionModel model = model_to_save();
  model.gate->largest_disagreement = std::numeric_limits<double>::infinity();
  const std::string saved = model_text(model);
  EXPECT_EQ(model_text(parse_model(saved, "model.json")), saved);
}

TEST(ModelFile, TruncatedAnywhereItIsRefused) {
  const std::string text = model_text(model_to_save());
  for (std::size_t size = 0; size + 2 < text.size(); size += 97)
    EXPECT_NE(refusal(text.substr(0, size)), "no error") << size;
  EXPECT_NE(refusal(text.substr(0, text.size() - 2)), "no error");
}

TEST(ModelFile, OtherFormatOrVersionIsRefused) {
  EXPECT_THAT(refusal_of([](json& j) { j["format"] = "onnx"; }),
              AllOf(HasSubstr("format"), HasSubstr("truebearing-correction")));
  EXPECT_THAT(refusal_of([](json& j) { j["version"] = 3; }), AllOf(HasSubstr("version"), HasSubstr("is 3")));
  EXPECT_THAT(refusal_of([](json& j) { j["version"] = "1"; }), HasSubstr("version"));
  EXPECT_THAT(refusal_of([](json& j) { j.erase("format"); }), HasSubstr("format: is missing"));
  EXPECT_THAT(refusal("[]"), HasSubstr("no object"));
  EXPECT_THAT(refusal("7"), HasSubstr("no object"));
}

TEST(ModelFile, EveryMissingKeyIsNamed) {
  const json good = json::parse(model_text(model_to_save()));
  for (const auto& [key, value] : good.items())
    EXPECT_THAT(refusal_of([&](json& j) { j.erase(key); }),
                AllOf(HasSubstr("model.json: " + key), HasSubstr("missing")));
  for (const auto& [key, value] : good["rules"][0].items())
    EXPECT_THAT(refusal_of([&](json& j) { j["rules"][2].erase(key); }), HasSubstr("rules[2]." + key));
  for (const auto& [key, value] : good["gate"].items())
    EXPECT_THAT(refusal_of([&](json& j) { j["gate"].erase(key); }), HasSubstr("gate." + key));
  for (const auto& [key, value] : good["normalisation"].items())
    EXPECT_THAT(refusal_of([&](json& j) { j["normalisation"].erase(key); }), HasSubstr("normalisation." + key));
}

// Every value of the file by itself replaced by one of another type: refused, naming where, whatever it is.
TEST(ModelFile, EveryWrongTypeIsRefused) {
  const json flat = json::parse(model_text(model_to_save())).flatten();
  for (const auto& [pointer, value] : flat.items())
    for (const json& wrong : {json::object(), json(true), value.is_string() ? json(1.0) : json("1.0")})
      EXPECT_NE(refusal_of([&](json& j) { j[json::json_pointer(pointer)] = wrong; }), "no error")
          << pointer << " = " << wrong;
}

TEST(ModelFile, WrongShapesAreRefused) {
  EXPECT_THAT(refusal_of([](json& j) { j["rules"][1]["centre"].push_back(0.0); }), HasSubstr("rules[1].centre"));
  EXPECT_THAT(refusal_of([](json& j) { j["rules"][1]["width"].erase(0); }), HasSubstr("rules[1].width"));
  EXPECT_THAT(refusal_of([](json& j) {
                j["rules"][1]["consequent"] = {1.0, 2.0, 3.0};
              }),
              HasSubstr("rules[1].consequent"));
  EXPECT_THAT(refusal_of([](json& j) { j["rules"] = json::array(); }), HasSubstr("rules"));
  EXPECT_THAT(refusal_of([](json& j) { j["features"] = json::array(); }), HasSubstr("features"));
  EXPECT_THAT(refusal_of([](json& j) { j["features"].erase(0); }), HasSubstr("input_mean"));
  EXPECT_THAT(refusal_of([](json& j) { j["normalisation"]["output_scale"].erase(0); }), HasSubstr("output_scale"));
  EXPECT_THAT(refusal_of([](json& j) { j["gate"]["low"].erase(0); }), HasSubstr("gate.low"));
  EXPECT_THAT(refusal_of([](json& j) { j["state"].push_back("more"); }), HasSubstr("3"));
  EXPECT_THAT(refusal_of([](json& j) { j["state"] = json::array(); }), HasSubstr("state"));
  EXPECT_THAT(refusal_of([](json& j) {
                while (j["rules"].size() <= 256) j["rules"].push_back(j["rules"][0]);
              }),
              HasSubstr("1 to 256"));
  EXPECT_THAT(refusal_of([](json& j) {
                while (j["features"].size() <= 16) j["features"].push_back(j["features"][0]);
              }),
              HasSubstr("1 to 16"));
}

TEST(ModelFile, NumberThatIsNoneIsRefusedWhereverItStands) {
  const json flat = json::parse(model_text(model_to_save())).flatten();
  int numbers = 0;
  for (const auto& [pointer, value] : flat.items()) {
    if (!value.is_number()) continue;
    ++numbers;
    json marked = json::parse(model_text(model_to_save()));
    marked[json::json_pointer(pointer)] = "MARK";
    const std::string text = marked.dump();
    const std::size_t place = text.find("\"MARK\"");
    for (const char* bad : {"NaN", "Infinity", "-Infinity", "1e999", "-1e999", "null"}) {
      const bool is_limit = pointer == "/gate/largest_disagreement";
      if (is_limit && std::string(bad) == "null") continue;  // null stands for none
      EXPECT_NE(refusal(std::string(text).replace(place, 6, bad)), "no error") << pointer << " = " << bad;
    }
  }
  EXPECT_GT(numbers, 60);
}

TEST(ModelFile, NumbersOutOfRangeAreRefused) {
  EXPECT_THAT(refusal_of([](json& j) { j["rules"][0]["width"][0] = -1.0; }), HasSubstr("width"));
  EXPECT_THAT(refusal_of([](json& j) { j["rules"][0]["width"][0] = 0.0; }), HasSubstr("width"));
  EXPECT_THAT(refusal_of([](json& j) { j["rules"][0]["inflation"] = 0.0; }), HasSubstr("inflation"));
  EXPECT_THAT(refusal_of([](json& j) { j["normalisation"]["input_scale"][0] = -1.0; }), HasSubstr("scale"));
  EXPECT_THAT(refusal_of([](json& j) { j["normalisation"]["output_scale"][0] = 0.0; }), HasSubstr("scale"));
  EXPECT_THAT(refusal_of([](json& j) { j["normalisation"]["input_clip"] = 0.0; }), HasSubstr("clip"));
  EXPECT_THAT(refusal_of([](json& j) { j["gate"]["low"][0] = 1e9; }), HasSubstr("gate"));
  EXPECT_THAT(refusal_of([](json& j) { j["gate"]["edge_fraction"] = 0.0; }), HasSubstr("edge_fraction"));
  EXPECT_THAT(refusal_of([](json& j) { j["gate"]["largest_disagreement"] = 0.0; }), HasSubstr("largest_disagreement"));
  EXPECT_THAT(refusal_of([](json& j) { j["base"] = ""; }), HasSubstr("name"));
}

TEST(ModelFile, UnknownKeyIsRefusedWithTheNearest) {
  EXPECT_THAT(refusal_of([](json& j) { j["featurs"] = 1.0; }),
              AllOf(HasSubstr("featurs"), HasSubstr("did you mean \"features\"")));
  EXPECT_THAT(refusal_of([](json& j) { j["rules"][3]["center"] = 1.0; }),
              AllOf(HasSubstr("rules[3].center"), HasSubstr("did you mean \"centre\"")));
  EXPECT_THAT(refusal_of([](json& j) { j["gate"]["hihg"] = 1.0; }), HasSubstr("did you mean \"high\""));
  EXPECT_THAT(refusal_of([](json& j) { j["features"][0]["scale"] = 1.0; }), HasSubstr("features[0].scale"));
  EXPECT_THAT(refusal_of([](json& j) { j["features"][0]["kind"] = "log_stepp"; }),
              HasSubstr("did you mean \"log_step\""));
}

TEST(ModelFile, KeyThatStandsTwiceIsRefused) {
  std::string text = model_text(model_to_save());
  text.replace(text.find("\"base\""), 6, "\"base\": \"a\", \"base\"");
  EXPECT_THAT(refusal(text), AllOf(HasSubstr("base"), HasSubstr("twice")));
}

TEST(ModelFile, DepthBombIsRefused) {
  for (const std::size_t depth : {65u, 100000u})
    for (const std::string& open : {std::string("["), std::string("{\"a\":")})
      EXPECT_NE(refusal(std::string(model_text(model_to_save()).substr(0, 1)) + "\"rules\":" +
                        [&] {
                          std::string bomb;
                          for (std::size_t level = 0; level < depth; ++level) bomb += open;
                          return bomb;
                        }()),
                "no error")
          << depth;
  std::string closed = std::string(65, '[') + std::string(65, ']');
  EXPECT_THAT(refusal(closed), HasSubstr("64 levels"));
}

TEST(ModelFile, OversizeIsRefusedBeforeItIsParsed) {
  const std::string text = model_text(model_to_save()) + std::string(1 << 20, ' ');
  EXPECT_THAT(refusal(text), HasSubstr("too large"));
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("truebearing_model_" + std::to_string(::getpid()) + ".json");
  std::ofstream(path) << text;
  EXPECT_THAT(error_message([&] { read_model_file(path); }), AllOf(HasSubstr(path.string()), HasSubstr("too large")));
  std::ofstream(path) << model_text(model_to_save());
  EXPECT_EQ(model_text(read_model_file(path)), model_text(model_to_save()));
  std::filesystem::remove(path);
  EXPECT_THAT(error_message([&] { read_model_file(path); }), HasSubstr(path.string()));
}

// Bytes changed, dropped and doubled at random: an InputError or a model that is valid and saves, and nothing else.
TEST(ModelFile, AlteredAnyhowItIsRefusedOrValid) {
  const std::string good = model_text(model_to_save());
  RandomStream random({.seed = 12}, StreamId::test);
  int refused = 0;
  for (int k = 0; k < 3000; ++k) {
    std::string text = good;
    for (std::uint64_t change = 0, changes = 1 + random.index(3); change < changes; ++change) {
      const std::size_t place = random.index(text.size());
      switch (random.index(4)) {
        case 0:
          text[place] = static_cast<char>(random.index(256));
          break;
        case 1:
          text.erase(place, 1 + random.index(20));
          break;
        case 2:
          text.insert(place, text.substr(random.index(text.size()), random.index(40)));
          break;
        default:
          text[place] = "0123456789eE+-.,:[]{}\"\\"[random.index(22)];
      }
    }
    try {
      const CorrectionModel model = parse_model(text, "model.json");
      model.validate();
      ASSERT_TRUE(model.rules().network.parameters().consequents.allFinite());
      ASSERT_EQ(model_text(parse_model(model_text(model), "again.json")), model_text(model));
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace truebearing::model_file_test
