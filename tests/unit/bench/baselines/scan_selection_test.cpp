// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/scan_selection.h"

#include <gtest/gtest.h>

namespace farfield::bench {
namespace {

using Scans = std::vector<std::size_t>;

// 0 is the root; 1 and 2 hang on it, 3 on 2, 4 on 3: a chain to the right.
const ScanTree kTree{{{0, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {0, 0, 0, 2, 3}};
const Scans kTriangles{100, 10, 20, 30, 40};
const glm::dvec3 kAtTheEnd(3, 0, 0);

TEST(ScanSelection, WithoutALimitAllAreDrawnAncestorsFirst) {
  EXPECT_EQ(select_scans(kTree, kAtTheEnd, {}, kTriangles), (Scans{0, 2, 3, 4, 1}));
  EXPECT_EQ(select_scans(kTree, {-1, 0, 0}, {}, kTriangles), (Scans{0, 1, 2, 3, 4}));
}

TEST(ScanSelection, ABudgetOfScansCutsThePathAtItsFarEnd) {
  EXPECT_EQ(select_scans(kTree, kAtTheEnd, {3, 0}, kTriangles), (Scans{0, 2, 3}));
  EXPECT_EQ(select_scans(kTree, kAtTheEnd, {1, 0}, kTriangles), (Scans{0}));
  EXPECT_EQ(select_scans(kTree, {-1, 0, 0}, {2, 0}, kTriangles), (Scans{0, 1}));
}

TEST(ScanSelection, ABudgetOfTrianglesHoldsButForTheIntraScan) {
  EXPECT_EQ(select_scans(kTree, kAtTheEnd, {0, 150}, kTriangles), (Scans{0, 2, 3}));
  EXPECT_EQ(select_scans(kTree, kAtTheEnd, {0, 149}, kTriangles), (Scans{0, 2}));
  EXPECT_EQ(select_scans(kTree, kAtTheEnd, {0, 1}, kTriangles), (Scans{0}));
}

TEST(ScanSelection, BothBudgetsHoldTogether) {
  EXPECT_EQ(select_scans(kTree, kAtTheEnd, {2, 190}, kTriangles), (Scans{0, 2}));
}

}  // namespace
}  // namespace farfield::bench
