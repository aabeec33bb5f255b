// SPDX-License-Identifier: Apache-2.0
// Cells: which surface points share an element, and which must not.
#include "radiance/field_cells.hpp"

#include <gtest/gtest.h>

namespace relumine {
namespace {

constexpr Vec3 up{0, 1, 0}, down{0, -1, 0};

CellScale scale() {
    CellScale s;
    s.size = 0.1f;
    s.finest = 2;
    s.core.add({-1, -1, -1});
    s.core.add({1, 1, 1});
    return s;
}

TEST(FieldCells, AnEmptyCellHasNoElement) {
    EXPECT_EQ(FieldCells(scale()).find({0.05f, 0, 0.05f}, up), no_element);
}

TEST(FieldCells, OneCellOneElement) {
    FieldCells cells(scale());
    const ElementId made = cells.find_or_make_fine({0.02f, 0.05f, 0.03f}, up, 0);
    EXPECT_EQ(cells.find_or_make_fine({0.08f, 0.05f, 0.09f}, up, 0), made);
    EXPECT_EQ(cells.find({0.08f, 0.06f, 0.01f}, up), made);
    EXPECT_EQ(cells.find({0.12f, 0.05f, 0.01f}, up), no_element);
    EXPECT_EQ(cells.elements().size(), 1u);
}

TEST(FieldCells, SidesOfAThinWallStayApart) {
    FieldCells cells(scale());
    const ElementId above = cells.find_or_make_fine({0.05f, 0.05f, 0.05f}, up, 0);
    EXPECT_EQ(cells.find({0.05f, 0.049f, 0.05f}, down), no_element);
    const ElementId below = cells.find_or_make_fine({0.05f, 0.049f, 0.05f}, down, 0);
    EXPECT_NE(above, below);
    EXPECT_EQ(cells.find({0.06f, 0.05f, 0.05f}, up), above);
    EXPECT_EQ(cells.find({0.06f, 0.049f, 0.05f}, down), below);
}

TEST(FieldCells, PlanesFarApartStayApart) {
    FieldCells cells(scale());
    const ElementId shelf = cells.find_or_make_fine({0.05f, 0.09f, 0.05f}, up, 0);
    EXPECT_NE(cells.find_or_make_fine({0.05f, 0.01f, 0.05f}, up, 0), shelf);
}

TEST(FieldCells, DividedCellsHaveChildren) {
    FieldCells cells(scale());
    const Vec3 here{0.01f, 0.001f, 0.01f}, there{0.09f, 0.001f, 0.09f};
    const ElementId parent = cells.find_or_make_fine(here, up, 0);
    cells.elements()[parent].divided = true;
    EXPECT_EQ(cells.find(here, up), parent) << "as long as there is no child";
    const ElementId child = cells.find_or_make_fine(here, up, 0);
    EXPECT_NE(child, parent);
    EXPECT_FLOAT_EQ(cells.elements()[child].size, 0.05f);
    EXPECT_EQ(cells.find(here, up), child);
    EXPECT_EQ(cells.find(there, up), parent);
}

TEST(FieldCells, CoarseElementsStandInUntilFineOnesAreMade) {
    FieldCells cells(scale());
    const Vec3 here{0.05f, 0.01f, 0.05f};
    const ElementId coarse = cells.find_or_make_coarse(here, up, 0);
    EXPECT_FLOAT_EQ(cells.elements()[coarse].size, 0.4f);
    EXPECT_EQ(cells.find({0.35f, 0.01f, 0.35f}, up), coarse);
    const ElementId fine = cells.find_or_make_fine(here, up, 0);
    EXPECT_NE(fine, coarse);
    EXPECT_EQ(cells.find(here, up), fine);
    EXPECT_EQ(cells.find_or_make_coarse(here, up, 0), fine);
    EXPECT_EQ(cells.find({0.35f, 0.01f, 0.35f}, up), coarse);
}

TEST(FieldCells, CellsGrowAwayFromTheCore) {
    const CellScale s = scale();
    EXPECT_EQ(s.coarsest_level({0.5f, 0, 0}), 0);
    EXPECT_LT(s.coarsest_level({100, 0, 0}), -3);
    EXPECT_GT(s.size_of(s.coarsest_level({100, 0, 0})), 1.0f);
}

TEST(FieldCells, ManyCellsAreAllFoundAgain) {
    FieldCells cells(scale());
    std::vector<ElementId> made;
    const auto place = [](int i) {
        return Vec3{0.1f * static_cast<float>(i % 100) + 0.05f, 0.05f,
                    0.1f * static_cast<float>(i / 100) + 0.05f};
    };
    for (int i = 0; i < 10'000; ++i) made.push_back(cells.find_or_make_fine(place(i) * 0.09f, up, 0));
    for (int i = 0; i < 10'000; ++i)
        EXPECT_EQ(cells.find(place(i) * 0.09f, up), made[static_cast<std::size_t>(i)]);
}

TEST(IrradianceVector, IsExactForTheNormalThatItWasMeasuredWith) {
    IrradianceVector v;
    v.add(Vec3{0, 1, 0} + Vec3{0.3f, 0, 0}, Spectrum{2});
    EXPECT_EQ(v.towards(up), Spectrum{2});
    EXPECT_GT(v.towards(normalize({0.2f, 1, 0})).r, v.towards(normalize({-0.2f, 1, 0})).r);
}

}  // namespace
}  // namespace relumine
