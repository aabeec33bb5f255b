// SPDX-License-Identifier: Apache-2.0
// Options and their values.
#include "cli/arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "cli/console.hpp"

namespace relumine::cli {
namespace {

/// Number of single-character edits between two words.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
        }
    }
    return row.back();
}

/// What a misspelt option may have meant; also what does not exist yet, which its refusal then explains.
std::vector<std::string> long_option_names(const CLI::App& app, std::span<const NotYet> not_yet) {
    std::vector<std::string> names;
    for (const NotYet& planned : not_yet) names.emplace_back(planned.name);
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

bool looks_like_option(const std::string& argument) { return argument.size() > 1 && argument[0] == '-'; }

UsageError unknown_option(const CLI::App& app, const std::string& argument, std::span<const NotYet> not_yet) {
    const std::string name = argument.substr(0, argument.find('='));
    const auto planned = std::ranges::find(not_yet, name, &NotYet::name);
    if (planned != not_yet.end()) return refusal(*planned);
    return UsageError(fmt::format("{}: expected a known option, found none of that name{}; --help lists all",
                                  name, did_you_mean(name, long_option_names(app, not_yet))));
}

/// Throws for the first argument that no option and no place took; options first: they explain the rest.
void refuse_extras(const CLI::App& app, const Arguments& extras, std::span<const NotYet> not_yet) {
    if (extras.empty()) return;
    const auto option = std::ranges::find_if(extras, looks_like_option);
    if (option != extras.end()) throw unknown_option(app, *option, not_yet);
    throw UsageError(fmt::format("expected no further argument, found \"{}\"", extras.front()));
}

/// CLI11's help without its double blank lines.
std::string help_text(const CLI::App& app) {
    std::string text = app.help();
    for (std::size_t gap = text.find("\n\n\n"); gap != std::string::npos; gap = text.find("\n\n\n"))
        text.erase(gap, 1);
    return text;
}

}  // namespace

UsageError refusal(const NotYet& thing) {
    return UsageError(fmt::format("{} is not available yet: it comes with {}", thing.name, thing.comes_with));
}

UsageError unexpected_value(std::string_view name, std::string_view expected, std::string_view found) {
    return UsageError(fmt::format("{}: expected {}, found \"{}\"", name, expected, found));
}

CLI::Option* add_file(CLI::App& app, const OptionText& text, std::string& target) {
    return app.add_option(text.names, target, text.purpose)->type_name(text.placeholder)->required();
}

bool parse(CLI::App& app, const Arguments& arguments, std::span<const NotYet> not_yet) {
    app.allow_extras();  // we word the refusal ourselves
    app.get_formatter()->column_width(32);
    app.set_help_flag("-h,--help", "this text");  // again, so that it comes last
    try {
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::CallForHelp&) {
        print(help_text(app));
        return false;
    } catch (const CLI::RequiredError& error) {
        refuse_extras(app, app.remaining(),
                      not_yet);  // a misspelt option explains better why something is missing
        throw UsageError(fmt::format("{}; --help lists all options", error.what()));
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    refuse_extras(app, app.remaining(), not_yet);
    return true;
}

std::string did_you_mean(std::string_view name, std::span<const std::string> candidates) {
    const auto distance = [&](const std::string& candidate) { return edit_distance(name, candidate); };
    const auto nearest = std::ranges::min_element(candidates, {}, distance);
    if (nearest == candidates.end() || distance(*nearest) > std::max<std::size_t>(1, name.size() / 3))
        return "";
    return fmt::format(" (did you mean \"{}\"?)", *nearest);
}

CLI::Option* add_value(CLI::App& app, const OptionText& text, const std::string& default_text,
                       const std::function<void(const std::string&)>& store) {
    const std::string purpose =
        default_text.empty() ? text.purpose : fmt::format("{} (default {})", text.purpose, default_text);
    return app.add_option_function<std::string>(text.names, store, purpose)
        ->type_name(text.placeholder)     // in errors
        ->option_text(text.placeholder);  // in help, without what it needs and excludes
}

CLI::Option* add_text(CLI::App& app, const OptionText& text, std::string& target) {
    return add_value(app, text, target, [&target](const std::string& value) { target = value; });
}

}  // namespace relumine::cli
