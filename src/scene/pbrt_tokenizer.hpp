// SPDX-License-Identifier: Apache-2.0
// Cuts pbrt scene files into tokens, each with its place.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relumine {

/// Where something stands in a file; shown as "file:line:column". Columns count bytes from 1.
struct PbrtPlace {
    std::shared_ptr<const std::string> file;
    int line = 1, column = 1;

    [[nodiscard]] std::string text() const;
};

/// Throws SceneError "file:line:column: expected …, found …".
[[noreturn]] void refuse_pbrt(const PbrtPlace& place, std::string_view expected, std::string_view found);

struct PbrtToken {
    enum class Kind { word, string, open_bracket, close_bracket };  // word: a directive, number or Boolean
    Kind kind = Kind::word;
    std::string text;  // of strings: what stands between the quotation marks, escapes decoded
    PbrtPlace place;

    [[nodiscard]] bool is_word(std::string_view word) const { return kind == Kind::word && text == word; }
};

/// How a token is called in messages.
[[nodiscard]] std::string describe(const PbrtToken& token);

/// The tokens of one file, one after the other; comments are skipped.
class PbrtTokenizer {
  public:
    PbrtTokenizer(std::string text, const std::string& file);

    /// Empty at the end of the file. Throws SceneError for strings that do not end on their line, unknown
    /// escapes and bytes that are no text.
    [[nodiscard]] std::optional<PbrtToken> next();
    [[nodiscard]] PbrtPlace place() const { return {file_, line_, column_}; }

  private:
    [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
    char take();
    void skip_blank();
    PbrtToken read_string(PbrtPlace begin);
    char read_escape(const PbrtPlace& begin);
    PbrtToken read_word(PbrtPlace begin);

    std::string text_;
    std::shared_ptr<const std::string> file_;
    std::size_t at_ = 0;
    int line_ = 1, column_ = 1;
};

}  // namespace relumine
