// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/iso_time.hpp"

#include <gtest/gtest.h>

namespace truebearing::iso_time_test {
namespace {

TEST(IsoTime, AnInstantIsTheSameHoweverItIsWritten) {
  for (const char* text :
       {"2023-11-14T22:13:20Z", "2023-11-14T22:13:20", "2023-11-14 22:13:20.000+00:00", "20231114T221320Z",
        "2023-11-15T00:13:20+02:00", "2023-11-14T17:43:20-0430", "2023-11-14t21:13:20-01", "2023-11-14 22:13:20 +0000"})
    EXPECT_EQ(seconds_of_iso_time(text), 1.7e9) << text;
  EXPECT_EQ(seconds_of_iso_time("1970-01-01T00:00Z"), 0.0);
  EXPECT_EQ(seconds_of_iso_time("1969-12-31T23:59:59.5Z"), -0.5);
  EXPECT_EQ(seconds_of_iso_time("2024-02-29T00:00:00,25Z"), 1709164800.25);
}

TEST(IsoTime, OtherTextIsNone) {
  for (const char* text : {"", "12.5", "2023-11-14", "22:13:20", "2023-02-29T00:00Z", "2023-11-14T24:13Z",
                           "2023-11-14T22:13:20ZZ", "2023-11-14T22:13:20.Z", "14/11/2023 22:13", "2023-11-14T22:13+1"})
    EXPECT_FALSE(seconds_of_iso_time(text)) << text;
}

}  // namespace
}  // namespace truebearing::iso_time_test
