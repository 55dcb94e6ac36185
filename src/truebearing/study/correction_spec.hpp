// SPDX-License-Identifier: Apache-2.0
// What a study says of a correction: which trackers it looks at, with which features, and how it is trained. Plain
// data.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/correction/correction_bounds.hpp"
#include "truebearing/correction/correction_design.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {

/// A scenario made of another: that of a file, or the study's own where `file` is empty, but for the keys in `changes`;
/// tables are merged key by key. Or a recorded track (CSV) as it is (RecordedFile).
struct ChangedScenario {
  std::filesystem::path file;
  SharedTable changes;

  bool is_recorded() const { return file.extension() == ".csv"; }
};

/// Reads the value of `key`: the name of a file, or a table of changes whose key `scenario`, where it has one, names it.
ChangedScenario read_changed_scenario(TableReader& table, const std::string& key);

/// How a correction network is trained.
struct TrainingSpec {
  enum class Method {
    variable_projection,  ///< scattered rules; the default
    back_propagation,     ///< the paper's own: a grid partition, all parameters by gradient descent
    recurrent             ///< of a recurrent network: back-propagation through time, on whole tracks
  };
  Method method = Method::variable_projection;
  std::size_t runs = 400;
  /// A smoother of the study that stands for the truth, which then is not looked at; empty: the truth itself.
  std::string teacher = {};
  int from_step = 1;     ///< number of the first step taught, counted from 1
  double every_s = 0.0;  ///< at most one step in as many seconds is taught; 0: every step
  /// Steps at which the base's error in a quantity exceeds its threshold are not taught: a track that has changed over
  /// to another target teaches nonsense.
  std::vector<std::pair<std::string, double>> leave_out_beyond = {};
  enum class Mirror {
    none,
    images,  ///< teach every run and its mirror image
    pairs    ///< rules come in pairs that mirror each other: the symmetry holds to the bit, for half the parameters
  };
  Mirror mirror = Mirror::none;
  int rules = 16;  ///< variable projection
  int iterations = 150;
  double learning_rate = 0.05;
  double ridge = 1e-3;
  int terms_per_input = 3;  ///< back-propagation
  int epochs = 300;
  double momentum = 0.0;
  int units = 48;                           ///< of a recurrent network
  int batch = 128;                          ///< tracks
  std::optional<ChangedScenario> scenario;  ///< what is taught; the study's own where absent
  /// Where given, the covariance head and the box of the gate are fitted to this (wider) scenario instead.
  std::optional<ChangedScenario> covariance_scenario;
};

/// How the box of the gate is fitted, whether or not the study's gate uses it.
struct BoxSpec {
  double quantile = 0.001;  ///< the box leaves out this share of the training data at either end of each feature
  double edge_fraction = 0.1;
  double disagreement_quantile =
      0.005;  ///< and this share of the corrections, those that disagreed most with the reference
  double disagreement_edge_fraction = 0.05;
};

struct CorrectionSpec {
  CorrectionDesign design;
  CorrectionBounds bounds;
  BoxSpec box;
  std::filesystem::path model;
  TrainingSpec training;

  /// Names of all trackers that run with it, each once: the design's and the fallback.
  std::vector<std::string> members() const;
};

CorrectionSpec read_correction_spec(TableReader& table);

}  // namespace truebearing
