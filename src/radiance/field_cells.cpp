// SPDX-License-Identifier: Apache-2.0
// Hashing of cells.
#include "radiance/field_cells.hpp"

#include <cmath>

#include "base/assert.hpp"
#include "base/hash.hpp"

namespace relumine {
namespace {

/// Whether an element stands for a point: normals and planes agree to within these.
constexpr float least_cosine = 0.8f;
constexpr float most_height = 0.35f;  // of the cell's size

constexpr int coarser = 2;  // octaves: of cells for what only light on its way meets
constexpr float finer_size = 1.0f / (1 << coarser);
constexpr int coarsest = -20;              // octaves
constexpr int most_cells = (1 << 18) - 2;  // along each axis, either way

float square_outside(const Bounds3& box, Vec3 p) {
    const auto axis = [](float lower, float upper, float x) {
        return std::max({lower - x, x - upper, 0.0f});
    };
    return length_squared(Vec3{axis(box.lower.x, box.upper.x, p.x), axis(box.lower.y, box.upper.y, p.y),
                               axis(box.lower.z, box.upper.z, p.z)});
}

}  // namespace

int CellScale::coarsest_level(Vec3 p) const {
    if (core.empty()) return 0;
    const float outside2 = square_outside(core, p);
    if (outside2 == 0) return 0;  // most
    const float outside = std::sqrt(outside2) / std::max(core.radius(), 1e-20f);
    if (outside < 1) return 0;
    return std::max(-static_cast<int>(std::log2(1 + outside)), coarsest);
}

float CellScale::size_of(int level) const { return std::ldexp(size, -level); }

FieldCells::FieldCells(const CellScale& scale) : scale_(scale), slots_(1 << 12) {
    for (std::size_t i = 0; i < levels; ++i)
        cells_per_metre_[i] = 1 / scale_.size_of(static_cast<int>(i) + lowest_level);
}

FieldCells::Index FieldCells::index_of(Vec3 p, int level) const {
    const float inverse = cells_per_metre_[level_index(level)];
    const auto cell = [&](float x) {
        return static_cast<std::int32_t>(std::clamp(std::floor(x * inverse), static_cast<float>(-most_cells),
                                                    static_cast<float>(most_cells)));
    };
    return {cell(p.x), cell(p.y), cell(p.z), level};
}

std::uint64_t FieldCells::key_of(const Index& i) {
    const auto bits = [](std::int32_t x) { return static_cast<std::uint64_t>(x + most_cells) & 0x7ffff; };
    return bits(i.x) << 44 | bits(i.y) << 25 | bits(i.z) << 6
           | static_cast<std::uint64_t>(i.level - coarsest + coarser + 1);
}

/// Four cells in a row along x are neighbours in memory, too: who asks for one will ask for the others.
std::size_t FieldCells::slot_of(std::uint64_t key) const {
    constexpr std::uint64_t in_row = std::uint64_t{3} << 44;
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = (mix(key & ~in_row) << 2 | (key & in_row) >> 44) & mask;
    while (slots_[slot].key != 0 && slots_[slot].key != key) slot = (slot + 1) & mask;
    return slot;
}

/// The element of the cell whose normal is nearest, among those that stand for the point.
ElementId FieldCells::match(const Index& index, Vec3 position, Vec3 normal) const {
    ElementId best = no_element;
    float best_cosine = least_cosine;
    for (ElementId e = first_in(index); e != no_element; e = next_[e]) {
        const FieldElement& element = elements_[e];
        const float cosine = dot(element.normal, normal);
        const float height = std::abs(dot(position - element.position, element.normal));
        const float fine_size = element.coarse ? element.size * finer_size : element.size;
        if (cosine <= best_cosine || height > most_height * fine_size) continue;
        best = e;
        best_cosine = cosine;
    }
    return best;
}

FieldCells::Place FieldCells::locate(Vec3 position, Vec3 normal) const {
    const int coarse = scale_.coarsest_level(position);
    Place place;
    for (int level = coarse; level <= coarse + scale_.finest; ++level) {
        const ElementId e = match(index_of(position, level), position, normal);
        if (e == no_element) {
            if (level == coarse) place.found = match(index_of(position, coarse - coarser), position, normal);
            return {place.found, level, true};
        }
        place.found = e;
        if (!elements_[e].divided) break;
    }
    return place;
}

ElementId FieldCells::find(Vec3 position, Vec3 normal) const { return locate(position, normal).found; }

ElementId FieldCells::find_or_make_fine(Vec3 position, Vec3 normal, float offset) {
    const Place place = locate(position, normal);
    return place.missing ? make(position, normal, offset, place.level) : place.found;
}

ElementId FieldCells::find_or_make_coarse(Vec3 position, Vec3 normal, float offset) {
    const ElementId found = find(position, normal);
    if (found != no_element) return found;
    const ElementId made = make(position, normal, offset, scale_.coarsest_level(position) - coarser);
    elements_[made].coarse = true;
    return made;
}

ElementId FieldCells::make(Vec3 position, Vec3 normal, float offset, int level) {
    if (2 * used_ >= slots_.size()) grow();
    const auto id = static_cast<ElementId>(elements_.size());
    FieldElement element;
    element.position = position;
    element.normal = normal;
    element.size = scale_.size_of(level);
    element.offset = offset;
    element.level = static_cast<std::int8_t>(level);
    elements_.push_back(element);
    used_levels_[level_index(level)] = true;
    const std::uint64_t key = key_of(index_of(position, level));
    Slot& slot = slots_[slot_of(key)];
    if (slot.key == 0) {
        slot.key = key;
        ++used_;
    }
    next_.push_back(slot.first);
    slot.first = id;
    return id;
}

void FieldCells::grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
        if (slot.key != 0) slots_[slot_of(slot.key)] = slot;
}

bool FieldCells::in_cell_of(const FieldElement& e, Vec3 position) const {
    const Index a = index_of(e.position, e.level), b = index_of(position, e.level);
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

Vec3 FieldCells::middle_of(const FieldElement& e) const {
    const Index i = index_of(e.position, e.level);
    return Vec3{static_cast<float>(i.x) + 0.5f, static_cast<float>(i.y) + 0.5f,
                static_cast<float>(i.z) + 0.5f}
           * e.size;
}

std::size_t FieldCells::bytes() const {
    return elements_.capacity() * sizeof(FieldElement) + next_.capacity() * sizeof(ElementId)
           + slots_.capacity() * sizeof(Slot);
}

}  // namespace relumine
