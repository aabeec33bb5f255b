// SPDX-License-Identifier: Apache-2.0
// Options and their values: one way to add them, one way to refuse them.
#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace relumine::cli {

using Arguments = std::vector<std::string>;

/// Arguments that make no sense: exit code 2. `what()` is one line.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Something of the documented command that does not exist yet.
struct NotYet {
    std::string_view name;        // "--error", "--method cache"
    std::string_view comes_with;  // "the cache method"
};
[[nodiscard]] UsageError refusal(const NotYet& thing);

/// Parses `arguments` into what the options of `app` point to; false when help was wanted and has been
/// printed. Throws UsageError; an unknown option is refused as planned if `not_yet` has it, else with the
/// nearest name.
[[nodiscard]] bool parse(CLI::App& app, const Arguments& arguments, std::span<const NotYet> not_yet = {});

/// " (did you mean \"--spp\"?)", or "" where no candidate is near.
[[nodiscard]] std::string did_you_mean(std::string_view name, std::span<const std::string> candidates);

/// "NAME: expected E, found "F"".
[[nodiscard]] UsageError unexpected_value(std::string_view name, std::string_view expected,
                                          std::string_view found);

/// The whole of `text` as a decimal number; a floating-point one is finite. Throws UsageError naming
/// `option`.
template <typename Number>
[[nodiscard]] Number parse_number(std::string_view option, std::string_view text) {
    Number value{};
    const char* begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(begin, end, value);
    bool good = error == std::errc{} && rest == end;
    if constexpr (std::floating_point<Number>) good = good && std::isfinite(value);
    if (good) return value;
    if constexpr (std::floating_point<Number>) throw unexpected_value(option, "a finite number", text);
    throw unexpected_value(option,
                           "a whole number from " + std::to_string(std::numeric_limits<Number>::min())
                               + " to " + std::to_string(std::numeric_limits<Number>::max()),
                           text);
}

/// What an option looks like in `--help`.
struct OptionText {
    std::string names;        // "-o,--output"
    std::string placeholder;  // "FILE"
    std::string purpose;      // "the picture: .exr, .png or .pfm"
};

/// `--name VALUE` with one value; `default_text` is shown unless empty.
CLI::Option* add_value(CLI::App& app, const OptionText& text, const std::string& default_text,
                       const std::function<void(const std::string&)>& store);

/// A file that must be named, without an option before it.
CLI::Option* add_file(CLI::App& app, const OptionText& text, std::string& target);

CLI::Option* add_text(CLI::App& app, const OptionText& text, std::string& target);

template <typename Number>
CLI::Option* add_number(CLI::App& app, const OptionText& text, Number& target,
                        const std::string& default_text) {
    const std::string name = text.names;
    return add_value(app, text, default_text, [&target, name](const std::string& value) {
        target = parse_number<Number>(name, value);
    });
}

}  // namespace relumine::cli
