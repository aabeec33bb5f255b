// SPDX-License-Identifier: Apache-2.0
// Directives of pbrt files, their arguments and parameter lists, Include and Import.
#include "scene/pbrt_parser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "base/file.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/pbrt_state.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

double to_number(const PbrtToken& token) {
    const std::string& text = token.text;
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    double value = 0;
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
    const bool whole = end == text.data() + text.size();
    if (token.kind != PbrtToken::Kind::word || !whole
        || (error != std::errc{} && error != std::errc::result_out_of_range))
        refuse_pbrt(token.place, "a number", describe(token));
    if (error == std::errc::result_out_of_range) return 0;  // pbrt reads what is too small as 0, too
    if (!std::isfinite(value) || std::abs(value) > 3.4e38)
        refuse_pbrt(token.place, "a finite number", describe(token));
    return value;
}

class Parser {
  public:
    Parser(PbrtFiles& files) : files_(files) {}

    PbrtScene parse(std::string text, const std::string& name) {
        sources_.emplace_back(std::move(text), name);
        run(0);
        return state_.finish(end_);
    }

  private:
    using Directive = void (Parser::*)(const PbrtToken&);
    struct Named {
        std::string_view name;
        Directive run;
    };
    static const std::vector<Named>& directives();

    /// Handles directives until the sources above `base` have ended.
    void run(std::size_t base) {
        base_ = base;
        while (const std::optional<PbrtToken> token = next()) dispatch(*token);
    }
    void dispatch(const PbrtToken& token);

    std::optional<PbrtToken> next();
    PbrtToken need(std::string_view what);
    std::string need_string(std::string_view what);
    double need_number() { return to_number(need("a number")); }
    PbrtTriple need_triple();
    Transform need_matrix();
    std::vector<PbrtParameter> parameters();
    PbrtParameter parameter(const PbrtToken& declaration);
    void add_value(PbrtParameter& parameter, const PbrtToken& token);

    void typed(const PbrtToken& token);  // directive "type" parameters
    void include(const PbrtToken& token);
    void import(const PbrtToken& token);
    void named(const PbrtToken& token);  // directive "name"
    void nesting(const PbrtToken& token);
    void transform(const PbrtToken& token);
    void texture(const PbrtToken& token);
    void option(const PbrtToken& token);
    void medium(const PbrtToken& token);
    void push_source(const PbrtToken& token);

    PbrtFiles& files_;
    PbrtState state_;
    std::vector<PbrtTokenizer> sources_;
    std::size_t base_ = 0;
    std::optional<PbrtToken> pending_;
    PbrtPlace end_;
};

const std::vector<Parser::Named>& Parser::directives() {
    static const std::vector<Named> table{
        {"Accelerator", &Parser::typed},
        {"ActiveTransform", &Parser::transform},
        {"AreaLightSource", &Parser::typed},
        {"Attribute", &Parser::typed},
        {"AttributeBegin", &Parser::nesting},
        {"AttributeEnd", &Parser::nesting},
        {"Camera", &Parser::typed},
        {"ColorSpace", &Parser::named},
        {"ConcatTransform", &Parser::transform},
        {"CoordSysTransform", &Parser::named},
        {"CoordinateSystem", &Parser::named},
        {"Film", &Parser::typed},
        {"Identity", &Parser::transform},
        {"Import", &Parser::import},
        {"Include", &Parser::include},
        {"Integrator", &Parser::typed},
        {"LightSource", &Parser::typed},
        {"LookAt", &Parser::transform},
        {"MakeNamedMaterial", &Parser::typed},
        {"MakeNamedMedium", &Parser::medium},
        {"Material", &Parser::typed},
        {"MediumInterface", &Parser::medium},
        {"NamedMaterial", &Parser::named},
        {"ObjectBegin", &Parser::named},
        {"ObjectEnd", &Parser::nesting},
        {"ObjectInstance", &Parser::named},
        {"Option", &Parser::option},
        {"PixelFilter", &Parser::typed},
        {"ReverseOrientation", &Parser::nesting},
        {"Rotate", &Parser::transform},
        {"Sampler", &Parser::typed},
        {"Scale", &Parser::transform},
        {"Shape", &Parser::typed},
        {"Texture", &Parser::texture},
        {"Transform", &Parser::transform},
        {"TransformBegin", &Parser::nesting},
        {"TransformEnd", &Parser::nesting},
        {"TransformTimes", &Parser::transform},
        {"Translate", &Parser::transform},
        {"WorldBegin", &Parser::nesting},
    };
    return table;
}

void Parser::dispatch(const PbrtToken& token) {
    if (token.kind != PbrtToken::Kind::word) refuse_pbrt(token.place, "a directive", describe(token));
    std::vector<std::string> names;
    for (const Named& directive : directives()) {
        if (directive.name == token.text) return (this->*directive.run)(token);
        names.emplace_back(directive.name);
    }
    if (token.text == "WorldEnd")
        refuse_pbrt(token.place, "a directive of pbrt-v4", "\"WorldEnd\" of pbrt-v3, which v4 has no more");
    refuse_pbrt(token.place, "a directive", describe(token) + did_you_mean(token.text, names));
}

std::optional<PbrtToken> Parser::next() {
    if (pending_) return std::exchange(pending_, std::nullopt);
    while (sources_.size() > base_) {
        if (std::optional<PbrtToken> token = sources_.back().next()) return token;
        end_ = sources_.back().place();
        sources_.pop_back();
    }
    return {};
}

PbrtToken Parser::need(std::string_view what) {
    std::optional<PbrtToken> token = next();
    if (!token) refuse_pbrt(end_, what, "the end of the file");
    return *std::move(token);
}

std::string Parser::need_string(std::string_view what) {
    PbrtToken token = need(what);
    if (token.kind != PbrtToken::Kind::string)
        refuse_pbrt(token.place, fmt::format("{} in quotation marks", what), describe(token));
    return std::move(token.text);
}

PbrtTriple Parser::need_triple() {
    PbrtTriple triple{};
    for (double& x : triple) x = need_number();
    return triple;
}

/// 16 numbers column by column, in brackets.
Transform Parser::need_matrix() {
    const PbrtToken open = need("[");
    if (open.kind != PbrtToken::Kind::open_bracket)
        refuse_pbrt(open.place, "[ and 16 numbers", describe(open));
    std::array<double, 16> columns{};
    for (double& x : columns) x = need_number();
    const PbrtToken close = need("]");
    if (close.kind != PbrtToken::Kind::close_bracket)
        refuse_pbrt(close.place, "] after 16 numbers", describe(close));
    const double w = columns[15];
    if (columns[3] != 0 || columns[7] != 0 || columns[11] != 0 || w == 0)
        refuse_pbrt(open.place, "an affine matrix, column by column", "a projective one");
    for (double& x : columns) x /= w;
    return transform_from_columns(columns);
}

std::vector<PbrtParameter> Parser::parameters() {
    std::vector<PbrtParameter> list;
    while (std::optional<PbrtToken> token = next()) {
        if (token->kind != PbrtToken::Kind::string) {
            pending_ = std::move(token);
            break;
        }
        list.push_back(parameter(*token));
    }
    return list;
}

PbrtParameter Parser::parameter(const PbrtToken& declaration) {
    constexpr std::string_view blank = " \t";
    const std::string& text = declaration.text;
    const std::size_t type = text.find_first_not_of(blank);
    const std::size_t type_end = std::min(text.find_first_of(blank, type), text.size());
    const std::size_t name = text.find_first_not_of(blank, type_end);
    if (type == text.npos || name == text.npos)
        refuse_pbrt(declaration.place, "\"type name\" of a parameter", describe(declaration));
    PbrtParameter parameter;
    parameter.type = text.substr(type, type_end - type);
    parameter.name = text.substr(name, std::min(text.find_first_of(blank, name), text.size()) - name);
    parameter.place = declaration.place;
    parameter.color_space = state_.color_space();
    const PbrtToken first = need("a value for " + quote(parameter.name));
    if (first.kind != PbrtToken::Kind::open_bracket) {
        add_value(parameter, first);
    } else {
        for (PbrtToken token = need("]"); token.kind != PbrtToken::Kind::close_bracket; token = need("]"))
            add_value(parameter, token);
    }
    check_pbrt_parameter(parameter);
    return parameter;
}

void Parser::add_value(PbrtParameter& parameter, const PbrtToken& token) {
    if (token.kind == PbrtToken::Kind::string)
        parameter.strings.push_back(token.text);
    else if (token.is_word("true") || token.is_word("false"))
        parameter.booleans.push_back(token.text == "true");
    else
        parameter.numbers.push_back(to_number(token));
}

void Parser::typed(const PbrtToken& token) {
    const std::string& directive = token.text;
    const std::string type = need_string("a type or name for " + directive);
    std::vector<PbrtParameter> list = parameters();
    const PbrtPlace& place = token.place;
    if (directive == "Shape") return state_.add_shape(type, std::move(list), place);
    if (directive == "Material") return state_.set_material(type, std::move(list), place);
    if (directive == "MakeNamedMaterial") return state_.make_named_material(type, std::move(list), place);
    if (directive == "LightSource") return state_.add_light(type, std::move(list), place);
    if (directive == "AreaLightSource") return state_.set_area_light(type, std::move(list), place);
    if (directive == "Attribute") return state_.set_attribute(type, std::move(list), place);
    state_.set_option(directive, type, std::move(list), place);
}

void Parser::push_source(const PbrtToken& token) {
    const std::string name = need_string("a file for " + token.text);
    if (sources_.size() >= max_include_depth)
        refuse_pbrt(token.place, fmt::format("at most {} files inside each other", max_include_depth),
                    "more");
    const std::vector<std::uint8_t> bytes = files_.read(name, token.place);
    sources_.emplace_back(std::string(bytes.begin(), bytes.end()), files_.resolve(name, token.place));
}

void Parser::include(const PbrtToken& token) { push_source(token); }

void Parser::import(const PbrtToken& token) {
    PbrtGraphicsState saved = state_.begin_import(token.place);
    const std::size_t outer = base_, depth = state_.depth();
    push_source(token);
    run(sources_.size() - 1);
    base_ = outer;
    if (state_.depth() != depth)
        refuse_pbrt(end_, "as many AttributeEnd as AttributeBegin in an imported file", "others");
    state_.end_import(std::move(saved));
}

void Parser::named(const PbrtToken& token) {
    PbrtToken name = need("a name for " + token.text);
    if (name.kind != PbrtToken::Kind::string)
        refuse_pbrt(name.place, fmt::format("a name for {} in quotation marks", token.text), describe(name));
    if (token.is_word("ColorSpace")) return state_.set_color_space(name);
    if (token.is_word("CoordinateSystem")) return state_.name_transform(name.text);
    if (token.is_word("CoordSysTransform")) return state_.use_named_transform(name.text, name.place);
    if (token.is_word("NamedMaterial")) return state_.use_named_material(name.text, name.place);
    if (token.is_word("ObjectBegin")) return state_.begin_object(name.text, token.place);
    state_.add_instance(name.text, name.place);
}

void Parser::nesting(const PbrtToken& token) {
    if (token.is_word("WorldBegin")) return state_.begin_world(token.place);
    if (token.is_word("ObjectEnd")) return state_.end_object(token.place);
    if (token.is_word("ReverseOrientation")) return state_.reverse_orientation(token.place);
    if (token.text.ends_with("Begin")) return state_.push(token.place);
    state_.pop(token.place);
}

void Parser::transform(const PbrtToken& token) {
    const std::string& directive = token.text;
    if (directive == "Identity") return state_.set_transform(Transform{});
    if (directive == "Transform") return state_.set_transform(need_matrix());
    if (directive == "ConcatTransform") return state_.concat(need_matrix());
    if (directive == "Translate") return state_.concat(pbrt_translate(need_triple()));
    if (directive == "Scale") return state_.concat(pbrt_scale(need_triple()));
    if (directive == "ActiveTransform") return state_.set_active_transform(need("All, StartTime or EndTime"));
    if (directive == "TransformTimes") {
        (void)need_number();
        (void)need_number();
    } else if (directive == "Rotate") {
        const double degrees = need_number();
        const PbrtTriple axis = need_triple();
        if (axis == PbrtTriple{}) refuse_pbrt(token.place, "an axis that is not 0", "0 0 0");
        state_.concat(pbrt_rotate(degrees, axis));
    } else {  // LookAt
        const PbrtTriple eye = need_triple(), look = need_triple(), up = need_triple();
        const std::optional<Transform> camera = pbrt_look_at(eye, look, up);
        if (!camera)
            refuse_pbrt(token.place, "two different points and an up vector across their line", "others");
        state_.concat(*camera);
    }
}

void Parser::texture(const PbrtToken& token) {
    const std::string name = need_string("a name for the texture");
    const std::string value = need_string("float or spectrum");
    const std::string type = need_string("the type of the texture");
    state_.add_texture(name, value, type, parameters(), token.place);
}

/// Options steer pbrt itself; ours are the command's.
void Parser::option(const PbrtToken&) {
    PbrtToken declaration = need("\"type name\" of an option");
    if (declaration.kind != PbrtToken::Kind::string)
        refuse_pbrt(declaration.place, "\"type name\" of an option", describe(declaration));
    (void)parameter(declaration);
}

void Parser::medium(const PbrtToken& token) {
    bool named = !need_string("the name of a medium").empty();
    if (token.is_word("MediumInterface")) {
        std::optional<PbrtToken> outside = next();
        named = named || (outside && outside->kind == PbrtToken::Kind::string && !outside->text.empty());
        if (outside && outside->kind != PbrtToken::Kind::string) pending_ = std::move(outside);
    } else {
        (void)parameters();
    }
    if (named) state_.ignore_media(token.place);
}

}  // namespace

PbrtScene parse_pbrt_text(std::string text, const std::string& name, PbrtFiles& files) {
    return Parser{files}.parse(std::move(text), name);
}

PbrtScene parse_pbrt(const std::string& path, PbrtFiles& files) {
    std::vector<std::uint8_t> bytes = read_file(path);
    if (is_gzip(bytes)) bytes = unpack_gzip(bytes, path);
    return parse_pbrt_text(std::string(bytes.begin(), bytes.end()), path, files);
}

}  // namespace relumine
