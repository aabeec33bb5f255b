// SPDX-License-Identifier: Apache-2.0
// Photons in a kd-tree, and the density of the nearest.
#include "radiance/caustic_map.hpp"

#include <nanoflann.hpp>

namespace relumine {
namespace {

constexpr float same_side = 0.9f;    // cosine between normals of one surface
constexpr float plane_share = 0.3f;  // of the kernel's radius: how far off the plane photons may lie
/// Of the box in which photons lie: the farthest that they are looked for.
constexpr float farthest_share = 0.03f;
constexpr std::uint32_t fewest_nearest = 32, most_nearest = 256;

/// As many as make both bias and variance go with the number of photons.
std::uint32_t nearest_of(std::size_t photons) {
    return std::clamp(static_cast<std::uint32_t>(0.2 * std::sqrt(static_cast<double>(photons))),
                      fewest_nearest, most_nearest);
}

/// Epanechnikov's kernel over a disk, 1/metres².
float kernel(float distance2, float radius2) {
    return std::max(0.0f, 1 - distance2 / radius2) * 2 * inv_pi / radius2;
}

bool on_plane(Vec3 offset, Vec3 normal, float radius2) {
    return sqr(dot(offset, normal)) <= sqr(plane_share) * radius2;
}

/// What nanoflann asks for.
struct Cloud {
    std::vector<Photon> photons;
    [[nodiscard]] std::size_t kdtree_get_point_count() const { return photons.size(); }
    [[nodiscard]] float kdtree_get_pt(std::size_t i, std::size_t axis) const {
        const Vec3 p = photons[i].position;
        return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

}  // namespace

struct CausticMap::Impl {
    explicit Impl(std::vector<Photon> given)
        : cloud{std::move(given)}, tree(3, cloud, {}), nearest(nearest_of(cloud.photons.size())) {
        Bounds3 box;
        for (const Photon& p : cloud.photons) box.add(p.position);
        if (!cloud.photons.empty()) farthest = farthest_share * box.radius();
    }

    Cloud cloud;
    Tree tree;
    std::uint32_t nearest;
    float farthest = 0;  // metres
};

CausticMap::CausticMap(std::vector<Photon> photons) : impl_(std::make_unique<Impl>(std::move(photons))) {}
CausticMap::~CausticMap() = default;

const std::vector<Photon>& CausticMap::photons() const { return impl_->cloud.photons; }

std::size_t CausticMap::bytes() const {
    return impl_->cloud.photons.capacity() * (sizeof(Photon) + sizeof(std::uint32_t));
}

Spectrum CausticMap::reflected(const Vertex& vertex, std::uint32_t most_specular) const {
    Spectrum sum;
    if (impl_->cloud.photons.empty() || is_delta(vertex.bsdf)) return sum;
    const SurfacePoint& p = vertex.point;
    std::array<std::uint32_t, most_nearest> ids;
    std::array<float, most_nearest> distances2;
    nanoflann::KNNResultSet<float, std::uint32_t, std::uint32_t> found(impl_->nearest);
    found.init(ids.data(), distances2.data());
    distances2[impl_->nearest - 1] = sqr(impl_->farthest);  // none beyond
    const std::array<float, 3> at{p.position.x, p.position.y, p.position.z};
    impl_->tree.findNeighbors(found, at.data(), {});
    const float radius2 = distances2[impl_->nearest - 1];
    if (!(radius2 > 0)) return sum;
    for (std::uint32_t i = 0; i < found.size(); ++i) {
        const Photon& photon = impl_->cloud.photons[ids[i]];
        if (photon.specular > most_specular || std::abs(dot(photon.normal, p.geometric_normal)) < same_side)
            continue;
        const WorldDir w_in{photon.from};
        if (!on_plane(photon.position - p.position, p.geometric_normal, radius2) || !sides_agree(p, w_in))
            continue;
        const float cosine = std::max(std::abs(dot(photon.from, photon.normal)), min_view_cosine);
        const Spectrum bsdf = eval(vertex.bsdf, vertex.w_out, p.frame.to_local(w_in));
        sum += bsdf * photon.flux * (kernel(distances2[i], radius2) / cosine);
    }
    return sum;
}

void CausticMap::add_arriving(const FieldElement& element, std::span<const StartPoint> points,
                              std::uint32_t most_specular, IrradianceVector& light) const {
    constexpr std::size_t most_points = 4;
    const std::size_t count = std::min(most_points, points.size());
    for (std::size_t i = 0; i < count; ++i)
        add_around(points[i * points.size() / count].position, element.normal, 0.5f * element.size,
                   most_specular, 1 / static_cast<float>(count), light);
}

void CausticMap::add_around(Vec3 position, Vec3 normal, float radius, std::uint32_t most_specular,
                            float share, IrradianceVector& light) const {
    if (impl_->cloud.photons.empty()) return;
    const float radius2 = sqr(radius);
    std::vector<std::pair<std::uint32_t, float>> found;
    nanoflann::RadiusResultSet<float, std::uint32_t> within(radius2, found);
    const std::array<float, 3> at{position.x, position.y, position.z};
    impl_->tree.findNeighbors(within, at.data(), {});
    for (const auto& [id, distance2] : found) {
        const Photon& photon = impl_->cloud.photons[id];
        if (photon.specular > most_specular || dot(photon.normal, normal) < same_side) continue;
        if (!on_plane(photon.position - position, normal, radius2) || dot(photon.from, normal) <= 0) continue;
        relumine::add_arriving(light, normal, photon.from,
                               photon.flux * (share * kernel(distance2, radius2)));
    }
}

Spectrum caustic_light(const Transport& t, const Vertex& vertex, std::uint32_t depth,
                       std::uint32_t max_depth) {
    if (!t.caustics || depth + 1 >= max_depth) return {};
    return t.caustics->reflected(vertex, max_depth - depth - 1);
}

}  // namespace relumine
