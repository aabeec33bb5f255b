// SPDX-License-Identifier: Apache-2.0
// The importances of a node's children against importance(), on every target.
#include <gtest/gtest.h>

#include "base/sample_stream.hpp"
#include "shading/light_tree.hpp"
#include "tests/targets.hpp"

namespace relumine {
namespace {

float number(std::uint32_t i, std::uint32_t j) {
    return SampleStream{29, i, 1, PointSet::independent}.next1(Dim::lobe, j);
}

LightCluster cluster(std::uint32_t i) {
    LightBounds b;
    const Vec3 corner{number(i, 0), number(i, 1), number(i, 2)};
    b.box.add(corner);
    if (i % 4 != 0) b.box.add(corner + Vec3{number(i, 3), number(i, 4), number(i, 5)} * 0.5f);
    b.normals = {normalize(Vec3{number(i, 6), number(i, 7), number(i, 8)} - Vec3{0.5f, 0.5f, 0.5f}),
                 i % 3 == 0 ? 0 : pi * number(i, 9)};
    b.spread = i % 5 == 0 ? 0.2f : 0.5f * pi;
    b.intensity = number(i, 10);
    b.two_sided = i % 6 == 0;
    return LightCluster(b);
}

TEST(LightTreeKernel, GivesTheBitsOfTheScalarDefinition) {
    testing::on_every_target([] {
        for (std::uint32_t i = 0; i < 500; ++i) {
            LightGroup group;
            const Vec3 from = Vec3{number(i, 20), number(i, 21), number(i, 22)} * 2 - Vec3{0.5f, 0.5f, 0.5f};
            for (std::uint32_t child = 0; child < 7; ++child) group.set(child, cluster(8 * i + child));
            LightGroup::Eight<float> values;
            importances(group, from, values);
            for (std::uint32_t child = 0; child < 7; ++child)
                ASSERT_EQ(values[child], importance(cluster(8 * i + child), from)) << i << ' ' << child;
            ASSERT_EQ(values[7], 0);  // there is no eighth child
        }
    });
}

TEST(LightTreeKernel, APlaceOnAPointLightIsFinite) {
    LightGroup group;
    LightBounds b;
    b.box.add({1, 2, 3});
    b.normals = {{0, 0, 1}, pi};
    b.spread = 0.5f * pi;
    b.intensity = 1;
    group.set(0, LightCluster(b));
    LightGroup::Eight<float> values;
    importances(group, {1, 2, 3}, values);
    EXPECT_TRUE(std::isfinite(values[0]) && values[0] > 0);
}

}  // namespace
}  // namespace relumine
