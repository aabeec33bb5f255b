// SPDX-License-Identifier: Apache-2.0
// A Mitsuba scene file as a tree of elements: includes read in, `$parameters` replaced, ids collected.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scene/pbrt_files.hpp"

namespace relumine {

/// Values of parameters by name; those that the user gives go before the file's defaults.
using MitsubaDefinitions = std::map<std::string, std::string>;

struct MitsubaElement {
    std::string tag;                                // "bsdf", "float", …
    std::string type;                               // of objects: "diffuse"
    std::string name, id;                           // "" where not given
    std::map<std::string, std::string> attributes;  // all of them
    PbrtPlace place;
    std::vector<std::unique_ptr<const MitsubaElement>> children;

    /// "" where it is not given.
    [[nodiscard]] const std::string& attribute(const std::string& key) const;
};

struct MitsubaDocument {
    std::unique_ptr<const MitsubaElement> root;
    std::map<std::string, const MitsubaElement*> by_id;  // aliases too
    std::vector<std::string> unused;                     // definitions that no `default` names
};

/// Throws SceneError for what is no XML, declares entities, is of a version before 2 or refers to parameters
/// that have no value. At most 32 files inside each other, 64 elements, and 2^23 elements in all.
[[nodiscard]] MitsubaDocument read_mitsuba_document(const std::string& path, PbrtFiles& files,
                                                    const MitsubaDefinitions& definitions);

}  // namespace relumine
