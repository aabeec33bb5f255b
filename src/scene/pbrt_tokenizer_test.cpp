// SPDX-License-Identifier: Apache-2.0
// Tokens of pbrt files and their places.
#include "scene/pbrt_tokenizer.hpp"

#include <gtest/gtest.h>

#include "relumine/error.hpp"

namespace relumine {
namespace {

using Kind = PbrtToken::Kind;

std::vector<PbrtToken> tokens(const std::string& text) {
    PbrtTokenizer tokenizer(text, "a.pbrt");
    std::vector<PbrtToken> all;
    while (auto token = tokenizer.next()) all.push_back(*token);
    return all;
}

std::string error_of(const std::string& text) {
    try {
        (void)tokens(text);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "";
}

TEST(PbrtTokenizer, CutsWordsStringsAndBrackets) {
    const auto all = tokens("Shape \"sphere\" \"float radius\"[1.5]");
    ASSERT_EQ(all.size(), 6u);
    EXPECT_TRUE(all[0].is_word("Shape"));
    EXPECT_EQ(all[1].kind, Kind::string);
    EXPECT_EQ(all[1].text, "sphere");
    EXPECT_EQ(all[2].text, "float radius");
    EXPECT_EQ(all[3].kind, Kind::open_bracket);
    EXPECT_TRUE(all[4].is_word("1.5"));
    EXPECT_EQ(all[5].kind, Kind::close_bracket);
}

TEST(PbrtTokenizer, KnowsLineAndColumn) {
    const auto all = tokens("# comment \"x\"\n\n  Scale 1\t2\r\n3# not this\n4");
    ASSERT_EQ(all.size(), 5u);
    EXPECT_EQ(all[0].place.text(), "a.pbrt:3:3");
    EXPECT_EQ(all[2].place.text(), "a.pbrt:3:11");
    EXPECT_EQ(all[3].place.text(), "a.pbrt:4:1");
    EXPECT_EQ(all[4].place.text(), "a.pbrt:5:1");
}

TEST(PbrtTokenizer, DecodesEscapes) {
    const auto all = tokens(R"("a\"b\\c\n\t")");
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].text, "a\"b\\c\n\t");
}

TEST(PbrtTokenizer, SkipsTheByteOrderMark) {
    const auto all = tokens("\xef\xbb\xbfWorldBegin");
    ASSERT_EQ(all.size(), 1u);
    EXPECT_TRUE(all[0].is_word("WorldBegin"));
    EXPECT_EQ(all[0].place.text(), "a.pbrt:1:1");
}

TEST(PbrtTokenizer, EmptyFilesHaveNoTokens) {
    EXPECT_TRUE(tokens("").empty());
    EXPECT_TRUE(tokens(" \n# nothing").empty());
}

TEST(PbrtTokenizer, RefusesWhatIsNoText) {
    EXPECT_EQ(error_of("a \"b"),
              "a.pbrt:1:3: expected a string that ends with \", found the end of the file");
    EXPECT_EQ(error_of("\"b\nc\""),
              "a.pbrt:1:1: expected a string that ends on its line, found a line break");
    EXPECT_NE(error_of("\"b\\q\"").find("a.pbrt:1:3: expected an escape"), std::string::npos);
    EXPECT_EQ(error_of(std::string{"ab\0c", 4}), "a.pbrt:1:3: expected text, found a control character");
    EXPECT_EQ(error_of(std::string{"\"b\0c\"", 5}), "a.pbrt:1:3: expected text, found a zero byte");
}

}  // namespace
}  // namespace relumine
