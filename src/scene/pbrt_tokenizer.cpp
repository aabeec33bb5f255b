// SPDX-License-Identifier: Apache-2.0
// Cuts pbrt scene files into tokens.
#include "scene/pbrt_tokenizer.hpp"

#include <fmt/format.h>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool ends_word(char c) { return is_blank(c) || c == '"' || c == '[' || c == ']' || c == '#'; }
bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

}  // namespace

std::string PbrtPlace::text() const { return fmt::format("{}:{}:{}", file ? *file : "", line, column); }

void refuse_pbrt(const PbrtPlace& place, std::string_view expected, std::string_view found) {
    throw SceneError{expected_found(place.text(), expected, found)};
}

std::string describe(const PbrtToken& token) {
    switch (token.kind) {
        case PbrtToken::Kind::open_bracket:
            return "[";
        case PbrtToken::Kind::close_bracket:
            return "]";
        case PbrtToken::Kind::string:
            return "the string " + quote(token.text);
        default:
            return quote(token.text);
    }
}

PbrtTokenizer::PbrtTokenizer(std::string text, const std::string& file)
    : text_(std::move(text)), file_(std::make_shared<const std::string>(file)) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // the byte order mark that some editors write
}

char PbrtTokenizer::take() {
    const char c = text_[at_++];
    if (c == '\n') {
        ++line_;
        column_ = 1;
    } else {
        ++column_;
    }
    return c;
}

void PbrtTokenizer::skip_blank() {
    while (!at_end()) {
        if (is_blank(text_[at_])) {
            take();
        } else if (text_[at_] == '#') {
            while (!at_end() && text_[at_] != '\n') take();
        } else {
            return;
        }
    }
}

std::optional<PbrtToken> PbrtTokenizer::next() {
    skip_blank();
    if (at_end()) return {};
    const PbrtPlace begin = place();
    const char c = text_[at_];
    if (c == '"') return read_string(begin);
    if (c == '[' || c == ']') {
        take();
        return PbrtToken{
            c == '[' ? PbrtToken::Kind::open_bracket : PbrtToken::Kind::close_bracket, {c}, begin};
    }
    return read_word(begin);
}

PbrtToken PbrtTokenizer::read_string(PbrtPlace begin) {
    take();
    std::string text;
    while (true) {
        if (at_end()) refuse_pbrt(begin, "a string that ends with \"", "the end of the file");
        const PbrtPlace here = place();
        const char c = take();
        if (c == '"') return {PbrtToken::Kind::string, std::move(text), std::move(begin)};
        if (c == '\n') refuse_pbrt(begin, "a string that ends on its line", "a line break");
        if (c == '\0') refuse_pbrt(here, "text", "a zero byte");
        text += c == '\\' ? read_escape(here) : c;
    }
}

char PbrtTokenizer::read_escape(const PbrtPlace& begin) {
    if (at_end()) refuse_pbrt(begin, "a string that ends with \"", "the end of the file");
    const char c = take();
    switch (c) {
        case 'b':
            return '\b';
        case 'f':
            return '\f';
        case 'n':
            return '\n';
        case 'r':
            return '\r';
        case 't':
            return '\t';
        case '\\':
        case '\'':
        case '"':
            return c;
        default:
            refuse_pbrt(begin, "an escape among \\b \\f \\n \\r \\t \\\\ \\' \\\"", quote({&c, 1}));
    }
}

PbrtToken PbrtTokenizer::read_word(PbrtPlace begin) {
    const std::size_t first = at_;
    while (!at_end() && !ends_word(text_[at_])) {
        if (is_control(text_[at_])) refuse_pbrt(place(), "text", "a control character");
        take();
    }
    return {PbrtToken::Kind::word, text_.substr(first, at_ - first), std::move(begin)};
}

}  // namespace relumine
