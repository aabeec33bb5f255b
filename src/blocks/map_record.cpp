// SPDX-License-Identifier: Apache-2.0
// What a record holds.
#include "blocks/map_record.hpp"

namespace relumine {

void MapRecord::clear_rays() {
    for (auto* axis : {&x, &y, &z}) axis->clear();
    seen.clear();
    open.clear();
}

void MapRecord::add(const SeenRadiance& ray, Vec3 position) {
    x.push_back(position.x);
    y.push_back(position.y);
    z.push_back(position.z);
    seen.push_back(ray);
}

void MapRecord::pad() {
    const std::size_t padded = (seen.size() + packet_size - 1) / packet_size * packet_size;
    for (auto* axis : {&x, &y, &z}) axis->resize(padded);
}

std::size_t MapRecord::bytes() const {
    return sizeof(MapRecord) + 3 * x.size() * sizeof(float) + seen.size() * sizeof(SeenRadiance)
           + open.size() * sizeof(OpenDirection);
}

}  // namespace relumine
