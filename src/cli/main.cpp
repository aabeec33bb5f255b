// SPDX-License-Identifier: Apache-2.0
// The command `relumine`: picks what to run and turns exceptions into one line and an exit code.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "relumine/error.hpp"
#include "relumine/render.hpp"

namespace relumine::cli {
namespace {

struct Command {
    std::string_view name;
    ExitCode (*run)(const Arguments&);
};
constexpr std::array<Command, 4> commands{
    {{"render", run_render}, {"info", run_info}, {"compare", run_compare}, {"inspect", run_inspect}}};
constexpr std::array<NotYet, 1> commands_not_yet{{{"relight", "stored light transport"}}};

constexpr std::string_view help = R"(Relumine renders scenes with physically based light.
Usage: relumine COMMAND [OPTIONS]

Commands:
  render SCENE -o FILE      a picture of a scene: .exr, .png or .pfm
  info SCENE                what a scene holds
  compare IMAGE REFERENCE   how far two pictures are apart
  inspect SCENE --pixel X,Y --out DIR
                            what the radiance cache does for one pixel

Options:
  -h,--help                 this text; after a command: its options
  --version                 the version

Exit codes: 0 done; 1 bad input or failed output; 2 bad usage; 3 stopped by a signal, picture saved.
Example: relumine render scenes/demo.glb -o demo.png --spp 64
)";

ExitCode run_command(const std::string& name, const Arguments& arguments) {
    const auto command = std::ranges::find(commands, name, &Command::name);
    if (command != commands.end()) return command->run(arguments);
    const auto planned = std::ranges::find(commands_not_yet, name, &NotYet::name);
    if (planned != commands_not_yet.end()) throw refusal(*planned);

    std::vector<std::string> names;
    names.reserve(commands.size());
    for (const Command& known : commands) names.emplace_back(known.name);
    throw UsageError(fmt::format("expected a command: render, info, compare or inspect, found \"{}\"{}", name,
                                 did_you_mean(name, names)));
}

ExitCode run(const Arguments& arguments) {
    if (arguments.empty())
        throw UsageError(
            "expected a command: render, info, compare or inspect, found none; --help tells more");
    const std::string& first = arguments.front();
    if (first == "-h" || first == "--help" || first == "help") {
        print(help);
        return ExitCode::done;
    }
    if (first == "--version") {
        print(fmt::format("relumine {}\n", version()));
        return ExitCode::done;
    }
    return run_command(first, {arguments.begin() + 1, arguments.end()});
}

/// "relumine render" where a command ran, else "relumine": what stands before a line on stderr.
std::string speaker(const Arguments& arguments) {
    const bool known = !arguments.empty()
                       && std::ranges::find(commands, arguments.front(), &Command::name) != commands.end();
    return known ? "relumine " + arguments.front() : "relumine";
}

}  // namespace

ExitCode exit_code_of(const std::exception& error) {
    const bool usage = dynamic_cast<const UsageError*>(&error) || dynamic_cast<const SettingsError*>(&error);
    return usage ? ExitCode::bad_usage : ExitCode::failed;
}

std::string line_of(const std::exception& error) {
    if (dynamic_cast<const std::bad_alloc*>(&error))
        return "memory: expected enough for the scene and the picture, found no more";
    const bool ours = dynamic_cast<const Error*>(&error) || dynamic_cast<const UsageError*>(&error);
    return ours ? error.what() : fmt::format("internal error: {}", error.what());
}

}  // namespace relumine::cli

int main(int argc, char** argv) {
    using namespace relumine::cli;
    secure_standard_streams();
    Arguments arguments;
    try {
        arguments.assign(argv + std::min(argc, 1), argv + argc);
        const ExitCode code = run(arguments);
        finish_output();
        return static_cast<int>(code);
    } catch (const std::exception& error) {
        print_line(fmt::format("{}: {}", speaker(arguments), line_of(error)));
        return static_cast<int>(exit_code_of(error));
    }
}
