// SPDX-License-Identifier: Apache-2.0
// Mitsuba's XML by pugixml, which reads no external entity: places, includes, parameters.
#include "scene/mitsuba_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>
#include <set>

#include "base/file.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr int max_include_depth = 32, max_depth = 64;
constexpr std::size_t max_elements = std::size_t{1} << 23;
constexpr std::size_t max_replaced = 65536;  // characters of a value after its parameters are replaced

const std::vector<std::string> object_tags{"bsdf",  "emitter", "film",  "integrator", "medium",
                                           "phase", "rfilter", "scene", "sampler",    "sensor",
                                           "shape", "texture", "volume"};
const std::vector<std::string> value_tags{"blackbody", "boolean", "float",  "integer",   "point", "rgb",
                                          "spectrum",  "srgb",    "string", "transform", "vector"};
const std::vector<std::string> control_tags{"alias", "default", "include", "path", "ref"};
const std::vector<std::string> transform_tags{"lookat", "matrix", "rotate", "scale", "translate"};

bool is_in(const std::vector<std::string>& tags, const std::string& tag) {
    return std::ranges::find(tags, tag) != tags.end();
}

/// Which attributes an element may have.
std::vector<std::string> attributes_of(const std::string& tag) {
    if (tag == "scene") return {"version", "type", "id", "name"};
    if (tag == "spectrum") return {"name", "value", "type", "id", "filename"};
    if (is_in(object_tags, tag)) return {"type", "id", "name", "version"};
    if (tag == "point" || tag == "vector") return {"name", "value", "x", "y", "z"};
    if (tag == "transform") return {"name", "id"};
    if (tag == "blackbody") return {"name", "temperature", "scale"};
    if (tag == "translate" || tag == "scale") return {"value", "x", "y", "z"};
    if (tag == "rotate") return {"value", "x", "y", "z", "angle"};
    if (tag == "matrix") return {"value"};
    if (tag == "lookat") return {"origin", "target", "up"};
    if (tag == "ref") return {"id", "name"};
    if (tag == "include") return {"filename"};
    if (tag == "alias") return {"id", "as"};
    if (tag == "path") return {"value"};
    return {"name", "value", "id"};
}

/// One file: its text, and where lines begin.
class File {
  public:
    File(std::string text, const std::string& name)
        : text_(std::move(text)), name_(std::make_shared<const std::string>(name)) {
        for (std::size_t i = 0; i < text_.size(); ++i)
            if (text_[i] == '\n') starts_.push_back(i + 1);
    }
    /// Of the byte `offset`; of elements: where their name stands.
    [[nodiscard]] PbrtPlace place(std::ptrdiff_t offset) const {
        const std::size_t at = std::clamp<std::size_t>(
            static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)), 0, text_.size());
        const auto next = std::ranges::upper_bound(starts_, at);
        const auto line = static_cast<std::size_t>(next - starts_.begin());
        return {name_, static_cast<int>(line), static_cast<int>(at - starts_[line - 1]) + 1};
    }
    [[nodiscard]] const std::string& text() const { return text_; }
    [[nodiscard]] const std::string& name() const { return *name_; }

  private:
    std::string text_;
    std::shared_ptr<const std::string> name_;
    std::vector<std::size_t> starts_{0};
};

class DocumentReader {
  public:
    DocumentReader(PbrtFiles& files, const MitsubaDefinitions& definitions)
        : files_(files), parameters_(definitions) {
        for (const auto& [name, value] : definitions) unused_.insert(name);
    }

    MitsubaDocument read(std::string text, const std::string& name) {
        auto root = std::make_unique<MitsubaElement>();
        root->tag = "scene";
        read_file(File(std::move(text), name), *root, 0);
        MitsubaDocument document;
        collect_ids(*root, document);
        add_aliases(document);
        document.root = std::move(root);
        document.unused.assign(unused_.begin(), unused_.end());
        return document;
    }

  private:
    struct Alias {
        std::string id, as;
        PbrtPlace place;
    };

    void read_file(const File& file, MitsubaElement& into, int depth);
    void read_children(const File& file, const pugi::xml_node& node, MitsubaElement& into, int depth);
    void read_child(const File& file, const pugi::xml_node& node, MitsubaElement& into, int depth);
    void read_control(const MitsubaElement& element, MitsubaElement& into, int depth);
    void include(const MitsubaElement& element, MitsubaElement& into, int depth);
    void check_root(const File& file, const pugi::xml_node& root) const;
    void check_attributes(const MitsubaElement& element) const;
    [[nodiscard]] std::string replaced(const std::string& text, const PbrtPlace& place) const;
    [[nodiscard]] MitsubaElement without_children(const File& file, const pugi::xml_node& node) const;
    static void collect_ids(const MitsubaElement& element, MitsubaDocument& document);
    void add_aliases(MitsubaDocument& document) const;

    PbrtFiles& files_;
    MitsubaDefinitions parameters_;
    std::set<std::string> unused_;
    std::vector<Alias> aliases_;
    std::size_t elements_ = 0;
    int include_depth_ = 0;
};

void DocumentReader::check_root(const File& file, const pugi::xml_node& root) const {
    const PbrtPlace place = file.place(root.offset_debug());
    if (std::string{root.name()} != "scene")
        refuse_pbrt(place, "<scene> around everything", fmt::format("<{}>", quote(root.name())));
    const std::string version = root.attribute("version").value();
    if (version.empty()) refuse_pbrt(place, "<scene version=\"3.0.0\">", "no version");
    if (version[0] != '2' && version[0] != '3')
        refuse_pbrt(place, "a scene of version 2 or 3 (Mitsuba's older names differ)", quote(version));
}

void DocumentReader::read_file(const File& file, MitsubaElement& into, int depth) {
    pugi::xml_document document;
    const unsigned flags = pugi::parse_default | pugi::parse_doctype;
    const pugi::xml_parse_result result =
        document.load_buffer(file.text().data(), file.text().size(), flags, pugi::encoding_utf8);
    if (!result) refuse_pbrt(file.place(result.offset), "well-formed XML", quote(result.description()));
    pugi::xml_node root;
    for (const pugi::xml_node node : document.children()) {
        const PbrtPlace place = file.place(node.offset_debug());
        if (node.type() == pugi::node_doctype) refuse_pbrt(place, "XML without entities", "<!DOCTYPE");
        if (node.type() != pugi::node_element) continue;
        if (root) refuse_pbrt(place, "one <scene>", fmt::format("also <{}>", quote(node.name())));
        root = node;
    }
    if (!root) refuse_pbrt(file.place(0), "<scene> around everything", "no element");
    check_root(file, root);
    if (depth == 0) into.place = file.place(root.offset_debug());
    read_children(file, root, into, depth);
}

void DocumentReader::read_children(const File& file, const pugi::xml_node& node, MitsubaElement& into,
                                   int depth) {
    for (const pugi::xml_node child : node.children()) {
        if (child.type() == pugi::node_element) read_child(file, child, into, depth + 1);
        if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata)
            refuse_pbrt(file.place(child.offset_debug()), "an element", quote(child.value()));
    }
}

std::string DocumentReader::replaced(const std::string& text, const PbrtPlace& place) const {
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        if (text[i] != '$') {
            out += text[i++];
            continue;
        }
        const auto in_name = [](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
        };
        std::size_t end = i + 1;
        while (end < text.size() && in_name(text[end])) ++end;
        const std::string name = text.substr(i + 1, end - i - 1);
        const auto it = parameters_.find(name);
        if (it == parameters_.end()) {
            std::vector<std::string> names;
            for (const auto& [known, value] : parameters_) names.push_back(known);
            refuse_pbrt(place, "a parameter that <default> or -D gives a value",
                        quote("$" + name) + did_you_mean(name, names));
        }
        out += it->second;
        if (out.size() > max_replaced)
            refuse_pbrt(place, fmt::format("values of at most {} characters", max_replaced), "more");
        i = end;
    }
    return out;
}

MitsubaElement DocumentReader::without_children(const File& file, const pugi::xml_node& node) const {
    MitsubaElement element;
    element.tag = node.name();
    element.place = file.place(node.offset_debug());
    if (element.tag == "lookAt") element.tag = "lookat";
    for (const pugi::xml_attribute attribute : node.attributes())
        if (!element.attributes.emplace(attribute.name(), replaced(attribute.value(), element.place)).second)
            refuse_pbrt(element.place, "each attribute once", quote(attribute.name()) + " twice");
    element.type = element.attribute("type");
    element.name = element.attribute("name");
    if (element.tag != "ref" && element.tag != "alias") element.id = element.attribute("id");
    return element;
}

void DocumentReader::check_attributes(const MitsubaElement& element) const {
    const std::vector<std::string> known = attributes_of(element.tag);
    for (const auto& [name, value] : element.attributes)
        if (!is_in(known, name))
            refuse_pbrt(element.place, fmt::format("<{}> with {}", element.tag, one_of(known)),
                        quote(name) + did_you_mean(name, known));
    if (is_in(object_tags, element.tag) && element.type.empty())
        refuse_pbrt(element.place, fmt::format("<{} type=…>", element.tag), "no type");
    const bool unnamed = element.tag == "transform" || is_in(value_tags, element.tag);
    if (unnamed && element.name.empty() && element.tag != "spectrum" && element.tag != "rgb")
        refuse_pbrt(element.place, fmt::format("<{} name=…>", element.tag), "no name");
}

void DocumentReader::read_child(const File& file, const pugi::xml_node& node, MitsubaElement& into,
                                int depth) {
    auto element = std::make_unique<MitsubaElement>(without_children(file, node));
    const PbrtPlace& place = element->place;
    if (depth > max_depth) refuse_pbrt(place, fmt::format("at most {} elements in a row", max_depth), "more");
    if (++elements_ > max_elements)
        refuse_pbrt(place, fmt::format("at most {} elements", max_elements), "more");
    const bool in_transform = into.tag == "transform",
               in_object = is_in(object_tags, into.tag) || into.tag == "spectrum";
    const auto fits = [&](const std::string& tag) {
        if (in_transform) return is_in(transform_tags, tag);
        if (!in_object) return false;
        return (is_in(object_tags, tag) && tag != "scene") || is_in(value_tags, tag)
               || is_in(control_tags, tag);
    };
    if (!fits(element->tag)) {
        std::vector<std::string> all = in_transform ? transform_tags : object_tags;
        if (!in_transform) {
            all.insert(all.end(), value_tags.begin(), value_tags.end());
            all.insert(all.end(), control_tags.begin(), control_tags.end());
        }
        refuse_pbrt(place,
                    in_transform ? "a step of a transform, " + one_of(transform_tags)
                    : in_object  ? std::string{"an object, a value or a reference"}
                                 : fmt::format("nothing inside of <{}>", into.tag),
                    fmt::format("<{}>{}", element->tag.size() < 40 ? element->tag : "…",
                                did_you_mean(element->tag, all)));
    }
    check_attributes(*element);
    if (is_in(control_tags, element->tag) && element->tag != "ref") {
        read_control(*element, into, depth);
        return;
    }
    read_children(file, node, *element, depth);
    into.children.push_back(std::move(element));
}

void DocumentReader::read_control(const MitsubaElement& element, MitsubaElement& into, int depth) {
    const auto needed = [&](const std::string& key) {
        if (element.attribute(key).empty())
            refuse_pbrt(element.place, fmt::format("<{} {}=…>", element.tag, key), "none");
        return element.attribute(key);
    };
    if (element.tag == "include") return include(element, into, depth);
    if (element.tag == "default") {
        const std::string name = needed("name");
        unused_.erase(name);
        if (!element.attributes.contains("value")) refuse_pbrt(element.place, "<default value=…>", "none");
        parameters_.emplace(name, element.attribute("value"));
        return;
    }
    if (element.tag == "path")
        refuse_pbrt(element.place, "files beside the scene", "<path>, another folder to look for them");
    if (into.tag != "scene")
        refuse_pbrt(element.place, "<alias> directly in <scene>", "it in <" + into.tag + ">");
    aliases_.push_back({needed("id"), needed("as"), element.place});
}

void DocumentReader::include(const MitsubaElement& element, MitsubaElement& into, int depth) {
    const std::string& name = element.attribute("filename");
    if (name.empty()) refuse_pbrt(element.place, "<include filename=…>", "none");
    if (++include_depth_ > max_include_depth)
        refuse_pbrt(element.place, fmt::format("at most {} files inside each other", max_include_depth),
                    "more, or a circle");
    const std::vector<std::uint8_t> bytes = files_.read(name, element.place);
    read_file(File({bytes.begin(), bytes.end()}, files_.resolve(name, element.place)), into, depth);
    --include_depth_;
}

void DocumentReader::collect_ids(const MitsubaElement& element, MitsubaDocument& document) {
    if (!element.id.empty() && !document.by_id.emplace(element.id, &element).second)
        refuse_pbrt(element.place, "a new id", fmt::format("{}, which exists", quote(element.id)));
    for (const auto& child : element.children) collect_ids(*child, document);
}

void DocumentReader::add_aliases(MitsubaDocument& document) const {
    for (const Alias& alias : aliases_) {
        const auto it = document.by_id.find(alias.id);
        if (it == document.by_id.end()) refuse_pbrt(alias.place, "the id of an object", quote(alias.id));
        if (!document.by_id.emplace(alias.as, it->second).second)
            refuse_pbrt(alias.place, "a new id", fmt::format("{}, which exists", quote(alias.as)));
    }
}

}  // namespace

const std::string& MitsubaElement::attribute(const std::string& key) const {
    static const std::string none;
    const auto it = attributes.find(key);
    return it == attributes.end() ? none : it->second;
}

MitsubaDocument read_mitsuba_document(const std::string& path, PbrtFiles& files,
                                      const MitsubaDefinitions& definitions) {
    const std::vector<std::uint8_t> bytes = read_file(path, std::size_t{1} << 30);
    return DocumentReader(files, definitions).read({bytes.begin(), bytes.end()}, path);
}

}  // namespace relumine
