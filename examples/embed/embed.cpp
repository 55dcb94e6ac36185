// SPDX-License-Identifier: Apache-2.0
// A corrected tracker in a program of your own. Reads lines "time_s position_m" from standard input:
//     embed radar_1d_family < measurements.txt
#include <cmath>
#include <iostream>

#include "truebearing/study/study.hpp"

int main(int argc, char** argv) try {
  const auto study = truebearing::Study::load(argc > 1 ? argv[1] : "radar_1d_family");
  const auto tracker = study.make_tracker("nfnn");
  truebearing::Measurement measurement;
  measurement.z.resize(1);
  while (std::cin >> measurement.time_s >> measurement.z[0])
    for (const truebearing::StepRecord& record : tracker->step(measurement))
      std::cout << record.time_s << " s: " << record.x[0] << " +- " << std::sqrt(record.P(0, 0)) << " m\n";
} catch (const truebearing::InputError& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
