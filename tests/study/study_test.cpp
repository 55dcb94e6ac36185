// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/radar_study.hpp"
#include "training/train_correction.hpp"
#include "truebearing/correction/model_file.hpp"

namespace truebearing::study_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::kStudy;
using ::testing::Not;
using testing::replaced;
using testing::TemporaryFolder;
using testing::write_study;

// What loading the small study says with `from` in it replaced.
std::string refusal(const std::string& from, const std::string& to) {
  const TemporaryFolder folder;
  const std::filesystem::path path = write_study(folder, replaced(kStudy, from, to));
  const std::string message = error_message([&] { Study::load(path); });
  if (message != "no error") {
    EXPECT_THAT(message, HasSubstr(".toml"));  // names a file
  }
  return message;
}

TEST(Study, SmallStudyIsValid) {
  const TemporaryFolder folder;
  const Study study = Study::load(write_study(folder));
  EXPECT_EQ(study.name(), "small");
  EXPECT_EQ(study.runs(), 20u);
  EXPECT_EQ(study.seed(), 5u);
  EXPECT_EQ(study.tuning_runs(), 20u);
  ASSERT_EQ(study.trackers().size(), 4u);
  EXPECT_EQ(study.trackers()[0].name, "plain");
  EXPECT_FALSE(study.tracker("wide").shown);
  EXPECT_EQ(study.pairs(), (std::vector<std::pair<std::string, std::string>>{{"nfnn", "tuned"}}));
  EXPECT_EQ(study.evaluation_scenarios().size(), 1u);
}

TEST(Study, UnknownKeysAreRefusedWithTheNearest) {
  EXPECT_THAT(refusal("runs = 20\nseed", "run = 20\nseed"),
              AllOf(HasSubstr("small.toml:4: run"), HasSubstr("did you mean \"runs\"")));
  EXPECT_THAT(refusal("[scoring]\n", "[scoring]\nfrom_steps = 2\n"),
              AllOf(HasSubstr("scoring.from_steps"), HasSubstr("\"from_step\"")));
  EXPECT_THAT(refusal("[tuning]\nruns", "[tuning]\nrun"), AllOf(HasSubstr("tuning.run"), HasSubstr("\"runs\"")));
  EXPECT_THAT(refusal("period_s = 1.0", "periods_s = 1.0"), HasSubstr("period_s"));
  EXPECT_THAT(refusal("variance_m2 = 1e7", "variance_m2 = 1e7, sigma_factr = 2.0"),
              HasSubstr("did you mean \"sigma_factor\""));
  EXPECT_THAT(refusal("kappa = 3.0", "kapa = 3.0"),
              AllOf(HasSubstr("trackers.nfnn"), HasSubstr("did you mean \"kappa\"")));
  EXPECT_THAT(refusal("rules = 4", "rule = 4"), AllOf(HasSubstr("trackers.nfnn.training"), HasSubstr("rules")));
  EXPECT_THAT(refusal("{ kind = \"log_step\" }", "{ kind = \"log_step\", scale = 2.0 }"),
              HasSubstr("features[0].scale"));
  EXPECT_THAT(refusal("kind = \"log_step\"", "kind = \"log_stp\""), HasSubstr("did you mean \"log_step\""));
  EXPECT_THAT(refusal("show = false", "shown = false"), HasSubstr("did you mean \"show\""));
}

TEST(Study, FaultsOfTrackersAreNamedWithTheirLines) {
  EXPECT_THAT(refusal("variance_m2 = 1e7", "variance_m2 = -1.0"),
              HasSubstr("small.toml:17: trackers.plain.measurement.variance_m2"));
  EXPECT_THAT(refusal("{ variance = [1e6, 53333.3] }", "{ variance = [1e6, -1.0] }"),
              HasSubstr("small.toml:27: trackers.wide.start.variance"));
  EXPECT_THAT(refusal("show = false", "show = 7"), HasSubstr("small.toml:26: trackers.wide.show"));
  EXPECT_THAT(refusal("offset = 0.05", "offsets = 0.05"),
              HasSubstr("small.toml:39: trackers.nfnn.features[2].offset: is missing"));
  EXPECT_THAT(refusal("base = \"plain\"\n", ""), HasSubstr("small.toml:29: trackers.nfnn.base: is missing"));
  EXPECT_THAT(
      refusal("\"companion_difference\", companion = \"wide\"", "\"companion_difference\", companion = \"nfnn\""),
      HasSubstr("small.toml:29: trackers.nfnn: "));
}

TEST(Study, FaultsOfAStudyThatIsLikeAnotherHaveItsOwnLines) {
  const TemporaryFolder folder;
  write_study(folder);
  const auto path =
      folder.write("child.toml", "like = \"small.toml\"\n[trackers.plain.measurement]\nvariance_m2 = -1.0\n");
  EXPECT_THAT(error_message([&] { Study::load(path); }),
              HasSubstr("child.toml:3: trackers.plain.measurement.variance_m2"));
}

TEST(Study, WrongTypesAreRefused) {
  EXPECT_THAT(refusal("name = \"small\"", "name = 7"), AllOf(HasSubstr("small.toml:1: name"), HasSubstr("text")));
  EXPECT_THAT(refusal("runs = 20\nseed", "runs = \"20\"\nseed"), AllOf(HasSubstr("runs"), HasSubstr("integer")));
  EXPECT_THAT(refusal("runs = 20\nseed", "runs = 20.5\nseed"), HasSubstr("integer"));
  EXPECT_THAT(refusal("kappa = 3.0", "kappa = true"), HasSubstr("kappa"));
  EXPECT_THAT(refusal("mirror = true", "mirror = 1"), HasSubstr("true or false"));
  EXPECT_THAT(refusal("show = false", "show = \"no\""), HasSubstr("true or false"));
  EXPECT_THAT(refusal("tune = [\"start.variance\"]", "tune = \"start.variance\""), HasSubstr("array of texts"));
  EXPECT_THAT(refusal("pairs = [\"nfnn - tuned\"]", "pairs = [1]"), HasSubstr("array of texts"));
  EXPECT_THAT(refusal("scenario = \"scenario.toml\"", "scenario = 1"), HasSubstr("scenario"));
  EXPECT_THAT(refusal("{ kind = \"log_step\" }", "1"), HasSubstr("array of tables"));
  EXPECT_THAT(refusal("[trackers.tuned]\nlike = \"plain\"", "[trackers.tuned]\nlike = 1"), HasSubstr("like"));
}

TEST(Study, NumbersOutOfRangeAreRefused) {
  EXPECT_THAT(refusal("runs = 20\nseed", "runs = 0\nseed"), HasSubstr("[1, 1000000000]"));
  EXPECT_THAT(refusal("seed = 5", "seed = -1"), HasSubstr("seed"));
  EXPECT_THAT(refusal("kappa = 3.0", "kappa = 0.0"), HasSubstr("kappa"));
  EXPECT_THAT(refusal("kappa = 3.0", "kappa = nan"), HasSubstr("kappa"));
  EXPECT_THAT(refusal("kappa = 3.0", "kappa = -inf"), HasSubstr("kappa"));
  EXPECT_THAT(refusal("rules = 4", "rules = 257"), HasSubstr("[1, 256]"));
  EXPECT_THAT(refusal("scale = 100.0", "scale = 0.0"), HasSubstr("scale"));
  EXPECT_THAT(refusal("offset = 0.05", "offset = -1.0"), HasSubstr("offset"));
  EXPECT_THAT(refusal("kappa = 3.0", "kappa = 3.0\ngate = { quantile = 0.5 }"), HasSubstr("gate.quantile"));
  EXPECT_THAT(refusal("kappa = 3.0", "kappa = 3.0\ngate = { disagreement_quantile = 0.6 }"),
              HasSubstr("gate.disagreement_quantile"));
  EXPECT_THAT(refusal("kappa = 3.0", "kappa = 3.0\ngate = { edge_fraction = 0.0 }"), HasSubstr("gate.edge_fraction"));
  EXPECT_THAT(refusal("position_m = 20000.0", "position_m = -1.0"), HasSubstr("loss_thresholds.position_m"));
}

TEST(Study, VariancesThatAreNoneAreRefused) {
  EXPECT_THAT(refusal("variance = [999.0, 999.0]", "variance = [999.0, 0.0]"),
              AllOf(HasSubstr("start.variance"), HasSubstr("> 0")));
  EXPECT_THAT(refusal("variance = [999.0, 999.0]", "variance = [999.0]"), HasSubstr("2 numbers"));
  EXPECT_THAT(refusal("variance = [5.0, 0.1]", "variance = [5.0, -0.1]"), HasSubstr("trackers.plain.motion.variance"));
  EXPECT_THAT(refusal("variance_m2 = 1e7", "variance_m2 = 0.0"), HasSubstr("trackers.plain.measurement.variance_m2"));
  EXPECT_THAT(refusal("variance_m2 = 1e7", "variance_m2 = -1e7"), HasSubstr("> 0"));
}

TEST(Study, MissingKeysAndFilesAreNamed) {
  EXPECT_THAT(refusal("name = \"small\"\n", ""), HasSubstr("name: is missing"));
  EXPECT_THAT(refusal("scenario = \"scenario.toml\"", "scenario = \"nowhere.toml\""), HasSubstr("nowhere.toml"));
  EXPECT_THAT(refusal("kind = \"kalman\"\n", ""), HasSubstr("trackers.plain"));
  EXPECT_THAT(refusal("base = \"plain\"\n", ""), HasSubstr("base: is missing; valid: text in quotes"));
  EXPECT_THAT(refusal("model = \"small.nfnn.json\"\n", "modl = \"small.nfnn.json\"\n"),
              HasSubstr("model: is missing; valid: text in quotes (did you mean it by \"modl\"?)"));
  EXPECT_THAT(refusal("model = \"small.nfnn.json\"\n", ""), HasSubstr("model"));
  EXPECT_THAT(error_message([] { Study::load("nowhere.toml"); }), HasSubstr("nowhere.toml"));
}

TEST(Study, IsFoundByNameWhereNoFileHasIt) {
  const std::filesystem::path shipped = Study::load("radar_1d_family").path();
  EXPECT_TRUE(std::filesystem::is_regular_file(shipped));
  EXPECT_EQ(shipped, Study::load("radar_1d_family.toml").path());
  EXPECT_EQ(Study::load(shipped).path(), shipped) << "a path is taken as it is";
  EXPECT_THAT(error_message([] { Study::load("nowhere/radar_1d_family"); }), HasSubstr("nowhere/radar_1d_family"));
  EXPECT_THAT(error_message([] { Study::load("radar_1d_famly"); }), HasSubstr("radar_1d_famly: cannot be opened"));
}

TEST(Study, NamesOfTrackersMustBeThere) {
  EXPECT_THAT(refusal("nfnn - tuned", "nfn - tuned"),
              AllOf(HasSubstr("scoring.pairs"), HasSubstr("did you mean \"nfnn\"")));
  EXPECT_THAT(refusal("nfnn - tuned", "nfnn"), HasSubstr("a - b"));
  EXPECT_THAT(refusal("[scoring]\n", "[scoring]\nbounds = [\"bank\"]\n"), HasSubstr("scoring.bounds"));
  EXPECT_THAT(refusal("base = \"plain\"", "base = \"plan\""), HasSubstr("did you mean \"plain\""));
  EXPECT_THAT(refusal("reference = \"tuned\"", "reference = \"tund\""), HasSubstr("did you mean \"tuned\""));
  EXPECT_THAT(refusal("companion = \"wide\"", "companion = \"wider\""), HasSubstr("did you mean \"wide\""));
  EXPECT_THAT(refusal("base = \"plain\"", "base = \"nfnn\""), HasSubstr("itself corrected"));
  EXPECT_THAT(refusal("position_m = 20000.0", "height_m = 20000.0"), HasSubstr("height_m"));
  EXPECT_THAT(refusal("kind = \"kalman\"", "kind = \"kalmann\""), HasSubstr("did you mean \"kalman\""));
}

TEST(Study, FeaturesThatTheRecordsCannotGiveAreRefused) {
  EXPECT_THAT(refusal("component = \"velocity_mps\"", "component = \"velocity_mph\""),
              HasSubstr("did you mean \"velocity_mps\""));
  const std::string with_bank = replaced(kStudy, "[trackers.plain]", R"([trackers.bank]
kind = "kalman_bank"
motion = { model = "constant_velocity", noise = "fixed", variance = [5.0, 0.1], period_s = 1.0 }
measurement = { model = "position", variance_m2 = 1e7 }
start = { x = [0.0, 0.0], variance = [999.0, 999.0] }
prior_velocities_mps = [0.0]
measurement_variance_factors = [1.0]
process_noise_factors = [1.0]

[trackers.plain])");
  const TemporaryFolder folder;
  const auto path = write_study(folder, replaced(with_bank, "base = \"plain\"", "base = \"bank\""));
  EXPECT_THAT(error_message([&] { Study::load(path); }), AllOf(HasSubstr("trackers.nfnn"), HasSubstr("innovation")));
}

TEST(Study, LikeTakesOverAWholeChain) {
  const TemporaryFolder folder;
  const Study study = Study::load(
      write_study(folder, kStudy + "\n[trackers.wider]\nlike = \"wide\"\nstart = { variance = [1e8, 1e6] }\n"));
  const std::string line = study.configuration_line("wider");
  EXPECT_THAT(line, AllOf(HasSubstr("variance = [100000000, 1000000]"), HasSubstr("x = [0, 0]"),
                          HasSubstr("variance_m2 = 10000000")));
  EXPECT_TRUE(study.tracker("wider").shown) << "whether it is shown is not inherited";
  EXPECT_TRUE(study.tracker("wide").tune.empty());
}

TEST(Study, LikeInACircleIsRefused) {
  EXPECT_THAT(refusal("[trackers.tuned]\nlike = \"plain\"", "[trackers.tuned]\nlike = \"tuned\""),
              HasSubstr("`like` itself"));
  EXPECT_THAT(refusal("[trackers.tuned]\nlike = \"plain\"",
                      "[trackers.a]\nlike = \"b\"\n[trackers.b]\nlike = \"a\"\n[trackers.tuned]\nlike = \"plain\""),
              HasSubstr("`like` itself"));
  EXPECT_THAT(refusal("[trackers.tuned]\nlike = \"plain\"", "[trackers.tuned]\nlike = \"plane\""),
              HasSubstr("did you mean \"plain\""));
}

TEST(Study, StudyCanBeLikeAnotherBesideIt) {
  const TemporaryFolder folder;
  write_study(folder);
  const Study child = Study::load(folder.write("child.toml", "name = \"child\"\nlike = \"small.toml\"\nruns = 7\n"));
  EXPECT_EQ(child.name(), "child");
  EXPECT_EQ(child.runs(), 7u);
  EXPECT_EQ(child.trackers().size(), 4u);
  EXPECT_EQ(child.trackers()[0].kind, Study::load(folder.path() / "small.toml").tracker(child.trackers()[0].name).kind);
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {"name = \"x\"\nlike = \"child.toml\"\n", "itself `like` another"},
           {"name = \"x\"\nlike = \"bad.toml\"\n", "itself `like` another"},
           {"name = \"x\"\nlike = \"nowhere/small.toml\"\n", "nowhere/small.toml"},
           {"name = \"x\"\nlike = \"nowhere.toml\"\n", "nowhere.toml"},
           {"name = \"x\"\nlike = \"small.toml\"\nrnus = 7\n", "did you mean \"runs\""}})
    EXPECT_THAT(error_message([&] { Study::load(folder.write("bad.toml", text)); }), HasSubstr(says)) << text;
}

TEST(Study, StudyCanBeLikeOneInAnotherFolder) {
  const TemporaryFolder folder;
  write_study(folder, kStudy + "\n[sets]\none = \"scenario.toml\"\ntwo = { scenario = \"scenario.toml\" }\n");
  const Study study = Study::load(folder.path() / "small.toml");
  for (const std::string& parent : {std::string("../small.toml"), (folder.path() / "small.toml").string()}) {
    const Study child =
        Study::load(folder.write("inner/child.toml", "name = \"child\"\nlike = \"" + parent + "\"\nruns = 7\n"));
    EXPECT_EQ(child.runs(), 7u);
    EXPECT_EQ(child.evaluation_scenarios().size(), 2u);
    EXPECT_TRUE(std::filesystem::weakly_canonical(child.parameters_path()) ==
                std::filesystem::weakly_canonical(study.parameters_path()));
    EXPECT_TRUE(std::filesystem::weakly_canonical(child.tracker("nfnn").correction->model) ==
                std::filesystem::weakly_canonical(study.tracker("nfnn").correction->model));
  }
}

TEST(Study, KeysOfTheParentsKindAreLeftBehind) {
  const std::string other = "[trackers.other]\nlike = \"plain\"\n";
  for (const char* changed :
       {"start = { kind = \"two_point\" }", "start = { kind = \"one_point\", velocity_sigma_mps = 100.0 }",
        "motion = { noise = \"discrete\", sigma_a_mps2 = 1.0 }",
        "motion = { noise = \"continuous\", q_m2ps3 = 1.0 }"}) {
    EXPECT_EQ(refusal("[trackers.wide]", other + changed + "\n[trackers.wide]"), "no error") << changed;
    const std::string misspelt = std::string(changed).insert(std::string(changed).find("{ ") + 2, "tpyo = 1, ");
    EXPECT_THAT(refusal("[trackers.wide]", other + misspelt + "\n[trackers.wide]"), HasSubstr("tpyo")) << changed;
  }
}

TEST(Study, ChildOfAnotherStudyLeavesItsKeysBehindToo) {
  const TemporaryFolder folder;
  write_study(folder);
  const auto child = [&](const std::string& start) {
    return error_message([&] {
      Study::load(folder.write("child.toml",
                               "name = \"child\"\nlike = \"small.toml\"\n[trackers.wide]\nstart = " + start + "\n"));
    });
  };
  EXPECT_EQ(child("{ kind = \"two_point\" }"), "no error");
  EXPECT_THAT(child("{ kind = \"two_point\", tpyo = 1 }"), HasSubstr("tpyo"));
}

// `n` trackers, each like the one before it in the file or the one behind it.
std::string chain(int n, bool deepest_first) {
  std::string text;
  const auto name = [&](int i) { return "t" + std::to_string(deepest_first ? n - i : i); };
  for (int i = 0; i < n; ++i)
    text += "[trackers." + name(i) + "]\nlike = \"" +
            ((deepest_first ? i == n - 1 : i == 0) ? "plain" : name(deepest_first ? i + 1 : i - 1)) + "\"\n";
  return text;
}

TEST(Study, LongChainsAndMuchThatIsTakenOverAreRefused) {
  for (const bool deepest_first : {false, true}) {
    EXPECT_EQ(refusal("[trackers.wide]", chain(32, deepest_first) + "[trackers.wide]"), "no error");
    for (const int links : {33, 1000, 10'000})
      EXPECT_THAT(refusal("[trackers.wide]", chain(links, deepest_first) + "[trackers.wide]"),
                  AllOf(HasSubstr("is `like` one that is `like` another"), HasSubstr("at most 32 times")));
  }
  std::string many = "[trackers.full]\nlike = \"plain\"\nmuch = [0";
  for (int i = 0; i < 10'000; ++i) many += ", 0";
  many += "]\n";
  for (int i = 0; i < 1000; ++i) many += "[trackers.f" + std::to_string(i) + "]\nlike = \"full\"\n";
  EXPECT_THAT(refusal("[trackers.wide]", many + "[trackers.wide]"), HasSubstr("more than 100000 values"));
}

TEST(Study, SetsAreWhatItIsComparedOn) {
  const TemporaryFolder folder;
  const Study study =
      Study::load(write_study(folder, kStudy + "\n[sets]\none = \"scenario.toml\"\ntwo = \"scenario.toml\"\n"));
  const std::vector<NamedScenario> sets = study.evaluation_scenarios();
  ASSERT_EQ(sets.size(), 2u);
  EXPECT_EQ(sets[1].name, "two");
  const std::string plane = std::string(TRUEBEARING_SOURCE_DIR) + "/data/scenarios/manoeuvre_2d.toml";
  for (const auto& [text, says] :
       std::vector<std::pair<std::string, std::string>>{{"one = 1", "sets.one"},
                                                        {"one = \"nowhere.toml\"", "nowhere.toml"},
                                                        {"one = \"" + plane + "\"", "has another truth"}})
    EXPECT_THAT(error_message([&] { Study::load(write_study(folder, kStudy + "\n[sets]\n" + text + "\n")); }),
                HasSubstr(says));
}

TEST(Study, ScenarioMayStandInTheStudy) {
  const TemporaryFolder folder;
  const std::string inside =
      "scenario = { kind = \"line\", period_s = 1.0, steps = 3, target = { position_m = 0.0, velocity_mps = 1.0 }, "
      "sensor = { position_sigma_m = 1.0 } }";
  const Study study = Study::load(write_study(folder, replaced(kStudy, "scenario = \"scenario.toml\"", inside)));
  EXPECT_EQ(study.scenario().simulate({}).measurements.size(), 3u);
}

TEST(Study, PathToTuneMustLeadToPositiveNumbers) {
  EXPECT_THAT(refusal("tune = [\"start.variance\"]", "tune = [\"start.varance\"]"),
              AllOf(HasSubstr("trackers.tuned.tune"), HasSubstr("start.varance")));
  EXPECT_THAT(refusal("tune = [\"start.variance\"]", "tune = [\"start.x\"]"), HasSubstr("> 0"));
}

TEST(Study, MissingParametersNameTheCommand) {
  const TemporaryFolder folder;
  const auto path = write_study(folder);
  std::filesystem::remove(folder.path() / "small.parameters.toml");
  const Study study = Study::load(path);
  const std::string command = "truebearing tune " + path.string();
  EXPECT_THAT(error_message([&] { study.make_tracker("tuned"); }), AllOf(HasSubstr("tuned"), HasSubstr(command)));
  EXPECT_THAT(error_message([&] { study.make_tracker_set(); }), HasSubstr(command));
  EXPECT_EQ(error_message([&] { study.make_tracker("plain"); }), "no error");
  folder.write("small.parameters.toml", "[tuned]\n\"start.variance\" = [1.0]\n");
  EXPECT_THAT(error_message([&] { Study::load(path).make_tracker("tuned"); }), HasSubstr(command))
      << "one number for two";
  folder.write("small.parameters.toml", "[tuned]\n\"start.variance\" = [1.0, -1.0]\n");
  EXPECT_THAT(error_message([&] { Study::load(path); }), AllOf(HasSubstr("small.parameters.toml:2"), HasSubstr("> 0")));
}

TEST(Study, TunedNumbersAreInTheTracker) {
  const TemporaryFolder folder;
  const Study study = Study::load(write_study(folder));
  EXPECT_THAT(study.configuration_line("tuned"), HasSubstr("variance = [1000000, 53000]"));
  EXPECT_THAT(study.configuration_line("plain"), HasSubstr("variance = [999, 999]"));
}

TEST(Study, MissingModelNamesTheCommand) {
  const TemporaryFolder folder;
  const auto path = write_study(folder);
  const Study study = Study::load(path);
  EXPECT_THAT(error_message([&] { study.make_tracker("nfnn"); }),
              AllOf(HasSubstr("small.nfnn.json"), HasSubstr("does not exist"),
                    HasSubstr("truebearing train " + path.string())));
}

TEST(Study, ModelThatWasTrainedForSomethingElseIsRefused) {
  const TemporaryFolder folder;
  const auto path = write_study(folder);
  folder.write("small.nfnn.json", model_text(train_correction(
                                      Study::load(path), "nfnn",
                                      {.seed = 1, .threads = 1, .teacher_progress = {}, .training_progress = {}})));
  EXPECT_EQ(error_message([&] { Study::load(path).make_tracker("nfnn"); }), "no error");
  const auto load = [&](const std::string& from, const std::string& to) {
    return error_message(
        [&] { Study::load(folder.write("small.toml", replaced(kStudy, from, to))).make_tracker("nfnn"); });
  };
  const auto says = [](const std::string& what) {
    return AllOf(HasSubstr("small.nfnn.json"), HasSubstr("was trained for"), HasSubstr(what),
                 HasSubstr("truebearing train"));
  };
  EXPECT_THAT(load("offset = 0.05", "offset = 0.06"), says("features"));
  EXPECT_THAT(load("  { kind = \"log_step\" },\n", ""), says("features"));
  EXPECT_THAT(load("reference = \"tuned\"", "reference = \"wide\""), says("reference"));
  EXPECT_THAT(load("kappa = 3.0", "output_in = \"sigma\"\ncovariance = \"moments\""), says("output_in, covariance"));
  EXPECT_THAT(load("variance = [999.0, 999.0]", "variance = [999.0, 998.0]"), says("plain"));
  EXPECT_THAT(load("variance = [1e6, 53333.3]", "variance = [1e6, 53333.4]"), says("wide"));
  folder.write("small.parameters.toml", replaced(testing::kParameters, "53000.0", "53001.0"));
  EXPECT_THAT(load("runs = 20\nseed", "runs = 21\nseed"), says("tuned")) << "tuned afresh since";
  folder.write("small.parameters.toml", testing::kParameters);
  EXPECT_EQ(load("rules = 4", "rules = 5"), "no error") << "how it was trained is no matter of what it fits";
  for (const char* bounds : {"kappa = 4.0", "", "gate = false", "kappa = 3.0\nreferee = true"})
    EXPECT_EQ(load("kappa = 3.0", bounds), "no error") << "what bounds it is the study's to say: " << bounds;
}

TEST(Study, GateWithoutABoxIsRefused) {
  const TemporaryFolder folder;
  const auto path = write_study(folder);
  const Study study = Study::load(path);
  CorrectionModel model =
      train_correction(study, "nfnn", {.seed = 1, .threads = 1, .teacher_progress = {}, .training_progress = {}});
  model.gate.reset();
  EXPECT_THAT(error_message([&] { study.check_model("nfnn", model, "here"); }),
              AllOf(HasSubstr("here"), HasSubstr("box"), HasSubstr("gate = false")));
  const Study free = Study::load(write_study(folder, replaced(kStudy, "kappa = 3.0", "gate = false")));
  EXPECT_EQ(error_message([&] { free.check_model("nfnn", model, "here"); }), "no error");
}

TEST(Study, BoundsOfACorrectionAreThreeSigmasAndAGateWhereItSaysNothing) {
  const TemporaryFolder folder;
  const auto bounds = [&](const std::string& text) {
    const Study study = Study::load(write_study(folder, replaced(kStudy, "kappa = 3.0", text)));
    return study.tracker("nfnn").correction->bounds;
  };
  EXPECT_EQ(bounds(""), CorrectionBounds{});
  EXPECT_EQ(bounds("").kappa, 3.0);
  EXPECT_TRUE(std::isinf(bounds("kappa = inf").kappa));
  EXPECT_FALSE(bounds("gate = false").gate);
  EXPECT_TRUE(bounds("gate = { quantile = 0.01 }").gate);
  EXPECT_TRUE(std::isinf(bounds("gate = { quantile = 0.01 }").longest_interval_s));
  EXPECT_EQ(bounds("gate = { longest_interval_s = 60 }").longest_interval_s, 60.0);
  EXPECT_EQ(bounds("referee = { edge = 0.5 }").referee->edge, 0.5);
}

TEST(Study, DeepNestingAndAbsurdSizesAreRefused) {
  EXPECT_THAT(refusal("runs = 20\nseed", "runs = " + std::string(100000, '[') + "\nseed"), HasSubstr("64 levels"));
  std::string dots = "a";
  for (int k = 0; k < 70; ++k) dots += ".a";
  EXPECT_THAT(refusal("runs = 20\nseed", dots + " = 1\nseed"), HasSubstr("64 levels"));
  EXPECT_THAT(refusal("name = \"small\"", "name = \"" + std::string(2 << 20, 'x') + "\""),
              HasSubstr("at most 1048576 bytes"));
}

TEST(Study, TextThatIsNoTomlIsNamedWithItsLine) {
  EXPECT_THAT(refusal("runs = 20\nseed", "runs = = 20\nseed"), HasSubstr("small.toml:4"));
  EXPECT_THAT(refusal("runs = 20\nseed", "runs = 20\nruns = 21\nseed"), HasSubstr("small.toml:5"));
}

TEST(Study, StudiesOfTheProjectAreValid) {
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "data/studies"))
    EXPECT_EQ(error_message([&] { Study::load(entry.path()); }), "no error") << entry.path();
}

}  // namespace
}  // namespace truebearing::study_test
