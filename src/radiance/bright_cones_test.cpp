// SPDX-License-Identifier: Apache-2.0
// Cones around bright elements: densities that integrate to 1, that `sample` follows, and that miss nothing
// bright.
#include "radiance/bright_cones.hpp"

#include <gtest/gtest.h>

#include "base/sample_stream.hpp"
#include "shading/sampling.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

constexpr Vec3 up{0, 1, 0};

/// A floor of 40 × 40 elements with two bright patches.
FieldCells floor_cells() {
    CellScale scale;
    scale.size = 0.1f;
    scale.core.add({-2, 0, -2});
    scale.core.add({2, 0, 2});
    FieldCells cells(scale);
    for (int x = -20; x < 20; ++x)
        for (int z = -20; z < 20; ++z) {
            const Vec3 p{(static_cast<float>(x) + 0.5f) * 0.1f, 0.01f, (static_cast<float>(z) + 0.5f) * 0.1f};
            FieldElement& e = cells.elements()[cells.find_or_make_fine(p, up, 0)];
            e.bright = (x >= 5 && x < 9 && z >= 5 && z < 12) || (x == -15 && z == -15);
        }
    return cells;
}

BrightCones cones_of(const FieldCells& cells) {
    std::vector<float> radiosity;
    for (const FieldElement& e : cells.elements()) radiosity.push_back(e.bright ? 10.0f : 0.1f);
    return {cells, radiosity};
}

WorldDir uniform_direction(Point2 u) {
    const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z));
    const auto [s, c] = sine_cosine_of_turns(u.y);
    return {{r * c, r * s, z}};
}

class ConesFrom : public ::testing::TestWithParam<Vec3> {};
INSTANTIATE_TEST_SUITE_P(Places, ConesFrom,
                         ::testing::Values(Vec3{0, 2, 0}, Vec3{-1, 0.5f, 1}, Vec3{0.7f, 0.05f, 0.8f}));

TEST_P(ConesFrom, DensityIntegratesToOne) {  // over the sphere, 2²⁰ Sobol points
    const FieldCells cells = floor_cells();
    const auto table = cones_of(cells).seen_from(GetParam(), -up);
    ASSERT_GT(table.count, 0u);
    constexpr std::uint32_t count = 1 << 20;
    double sum = 0;
    for (std::uint32_t i = 0; i < count; ++i)
        sum += double{
            pdf(table, uniform_direction(SampleStream{1, i, count, PointSet::sobol}.next2(Dim::direction)))};
    EXPECT_NEAR(sum * 4 * double{pi} / count, 1, 0.01);
}

TEST_P(ConesFrom, SamplesHaveTheDensityThatTheySay) {  // Σ g/p = ∫ g over the cones' union
    const FieldCells cells = floor_cells();
    const auto table = cones_of(cells).seen_from(GetParam(), -up);
    constexpr std::uint32_t count = 1 << 18;
    const auto g = [](WorldDir w) { return 1 + w.v.x + sqr(w.v.z); };
    double drawn = 0, uniform = 0, mutant = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Point2 u = SampleStream{2, i, count, PointSet::sobol}.next2(Dim::direction);
        const ConeSample s = sample(table, u);
        ASSERT_GT(s.pdf, 0);
        ASSERT_EQ(s.pdf, pdf(table, s.direction));
        drawn += double{g(s.direction) / s.pdf} / count;
        mutant += double{g(s.direction) / (1.03f * s.pdf)} / count;
        const WorldDir w = uniform_direction(u);
        if (pdf(table, w) > 0) uniform += double{g(w)} * 4 * double{pi} / count;
    }
    EXPECT_NEAR(drawn / uniform, 1, 0.015);
    EXPECT_GT(std::abs(mutant / uniform - 1), 0.015);
}

/// χ² of directions over cells of equal solid angle; `wider` opens the cones that are drawn from. As many
/// uniform directions are counted with them: cells that a cone hardly touches then expect something too.
double p_of_cells(const BrightCones::Table& table, float wider) {
    constexpr int rows = 32, columns = 64, fine = 24;
    constexpr std::uint32_t draws = 50'000;
    BrightCones::Table drawn_from = table;
    for (std::size_t i = 0; i < table.count; ++i) drawn_from.one_less_cosine[i] *= wider;
    std::vector<double> observed(rows * columns);
    std::vector<double> expected(rows * columns, double{draws} / (rows * columns));
    const auto count = [&](Vec3 w) {
        const float turn = std::atan2(w.y, w.x) / (2 * pi);
        const int row = std::clamp(static_cast<int>((1 - w.z) / 2 * rows), 0, rows - 1);
        const int column =
            std::clamp(static_cast<int>((turn < 0 ? turn + 1 : turn) * columns), 0, columns - 1);
        ++observed[static_cast<std::size_t>(row * columns + column)];
    };
    for (std::uint32_t i = 0; i < draws; ++i) {
        const SampleStream stream{3, i, 1, PointSet::independent};
        count(sample(drawn_from, stream.next2(Dim::direction)).direction.v);
        count(uniform_direction(stream.next2(Dim::light_point)).v);
    }
    const double share = 4 * double{pi} * draws / (rows * columns * fine * fine);
    for (int row = 0; row < rows * fine; ++row)
        for (int column = 0; column < columns * fine; ++column) {
            const WorldDir w = uniform_direction({(static_cast<float>(row) + 0.5f) / (rows * fine),
                                                  (static_cast<float>(column) + 0.5f) / (columns * fine)});
            expected[static_cast<std::size_t>(row / fine * columns + column / fine)] +=
                share * double{pdf(table, w)};
        }
    return testing::chi_square_p(observed, expected);
}

TEST_P(ConesFrom, DirectionsFollowTheDensity) {  // false-positive rate: 1e-6 each
    const FieldCells cells = floor_cells();
    const auto table = cones_of(cells).seen_from(GetParam(), -up);
    EXPECT_GT(p_of_cells(table, 1), 1e-6);
    EXPECT_LT(p_of_cells(table, 0.9f), 1e-6);  // cones narrower by 5 % must be caught
}

TEST_P(ConesFrom, EveryBrightPointCanBeDrawn) {
    const FieldCells cells = floor_cells();
    const auto table = cones_of(cells).seen_from(GetParam(), -up);
    for (const FieldElement& e : cells.elements()) {
        if (!e.bright) continue;
        for (const Vec3 corner :
             {Vec3{-1, 0, -1}, Vec3{1, 0, -1}, Vec3{-1, 0, 1}, Vec3{1, 0, 1}, Vec3{0, 0, 0}}) {
            const Vec3 way = e.position + corner * (0.499f * e.size) - GetParam();
            EXPECT_GT(pdf(table, {normalize(way)}), 0);
        }
    }
}

TEST(BrightCones, BelowTheHorizonThereAreNone) {
    EXPECT_EQ(cones_of(floor_cells()).seen_from({0, 2, 0}, up).count, 0u);
}

TEST(BrightCones, NothingBrightNoCones) {
    FieldCells cells = floor_cells();
    for (FieldElement& e : cells.elements()) e.bright = false;
    EXPECT_TRUE(cones_of(cells).empty());
}

}  // namespace
}  // namespace relumine
