// SPDX-License-Identifier: Apache-2.0
// The tests' own statistics against tabulated values.
#include "tests/statistics.hpp"

#include <gtest/gtest.h>

namespace relumine::testing {
namespace {

TEST(Statistics, TailsMatchTables) {
    EXPECT_NEAR(chi_square_tail(3.841, 1), 0.05, 1e-4);
    EXPECT_NEAR(chi_square_tail(124.342, 100), 0.05, 1e-4);
    EXPECT_NEAR(normal_p(1.959964), 0.05, 1e-6);
    EXPECT_NEAR(student_p(2.570582, 5), 0.05, 1e-6);
    EXPECT_NEAR(student_p(1.959964, 1e7), 0.05, 1e-5);
    EXPECT_NEAR(student_p(31.59905, 2), 0.001, 1e-6);
}

TEST(Statistics, WelchSeesADifferenceAndOnlyThat) {
    EXPECT_NEAR(welch_p({1, 0.1, 10}, {1, 0.2, 10}), 1, 1e-12);
    EXPECT_LT(welch_p({1, 0.01, 50}, {1.1, 0.01, 50}), 1e-6);
    EXPECT_EQ(welch_p({1, 0, 5}, {1, 0, 5}), 1);
    EXPECT_EQ(welch_p({1, 0, 5}, {2, 0, 5}), 0);
}

TEST(Statistics, ChiSquareAcceptsItsOwnExpectation) {
    const std::vector<double> expected{100, 200, 300}, skewed{140, 160, 300};
    EXPECT_EQ(chi_square_p(expected, expected), 1);
    EXPECT_LT(chi_square_p(skewed, expected), 1e-5);
}

}  // namespace
}  // namespace relumine::testing
