// SPDX-License-Identifier: Apache-2.0
// `relumine compare`: how far two pictures are apart, and whether that is near enough.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/outputs.hpp"
#include "cli/report.hpp"
#include "relumine/compare.hpp"

namespace relumine::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Thresholds {
    std::optional<double> relative_l1, rmse, relmse, mean, block, flip;  // largest that pass
};

struct Options {
    std::string image, reference;
    std::string difference_file;  // "": none
    CompareOptions compare;
    FlipOptions flip;
    Thresholds max;
    bool json = false;

    bool reference_blocks = false;  // the reference is a picture of block means
    std::string reference_se_file;
    BlockTolerance tolerance;
};

/// A number ≥ 0 that is not there unless given.
CLI::Option* add_limit(CLI::App& app, const OptionText& text, std::optional<double>& target) {
    const std::string name = text.names;
    return add_value(app, text, "", [&target, name](const std::string& value) {
        target = parse_number<double>(name, value);
        if (*target < 0) throw unexpected_value(name, "a number from 0", value);
    });
}

void add_threshold_options(CLI::App& app, Thresholds& max) {
    app.option_defaults()->group("Thresholds: exit code 1 where exceeded");
    add_limit(app, {"--max-relative-l1", "X", "of sum |image - reference| / sum reference"}, max.relative_l1);
    add_limit(app, {"--max-rmse", "X", "of the root mean square difference, in radiance"}, max.rmse);
    add_limit(app, {"--max-relmse", "X", "of the mean of difference^2 / (reference^2 + 0.01)"}, max.relmse);
    add_limit(app, {"--mean-tolerance", "X", "of |sum image / sum reference - 1|"}, max.mean);
    add_limit(app, {"--max-block", "X", "of the relative difference of block means, worst block"}, max.block);
    add_limit(app, {"--max-flip", "X", "of the mean of FLIP, 0 to 1"}, max.flip);
}

void add_block_options(CLI::App& app, Options& options) {
    app.option_defaults()->group(
        "With a reference of block means; errors include the layer \"variance\" of IMAGE if it has one");
    app.add_flag("--reference-blocks", options.reference_blocks,
                 "REFERENCE holds the mean of one block of IMAGE per pixel")
        ->option_text(" ");
    CLI::Option* blocks = app.get_option("--reference-blocks");
    add_text(app, {"--reference-se", "FILE", "standard errors of these means"}, options.reference_se_file)
        ->needs(blocks);
    BlockTolerance& tolerance = options.tolerance;
    add_number(app, {"--sigmas", "X", "combined standard errors that a block may be off"}, tolerance.sigmas,
               fmt::format("{}", tolerance.sigmas))
        ->needs(blocks);
    add_number(app, {"--relative", "X", "and in addition, relative to the reference"}, tolerance.relative,
               fmt::format("{}", tolerance.relative))
        ->needs(blocks);
    add_limit(app, {"--exclude-above", "X", "leave out blocks that are brighter, and their neighbours"},
              tolerance.exclude_above)
        ->needs(blocks);
    for (const char* per_pixel : {"--max-relative-l1", "--max-rmse", "--max-relmse", "--max-flip",
                                  "--exposure", "--difference", "--block"})
        blocks->excludes(app.get_option(per_pixel));
}

void add_options(CLI::App& app, Options& options) {
    add_file(app, {"IMAGE", "", ".exr, .pfm, .hdr, .png or .jpg"}, options.image);
    add_file(app, {"REFERENCE", "", "the same size, unless --reference-blocks"}, options.reference);
    app.option_defaults()->group("Output");
    add_number(app, {"--block", "N", "side of the blocks in pixels"}, options.compare.block_size,
               std::to_string(options.compare.block_size));
    add_number(app, {"--exposure", "EV", "stops, for FLIP"}, options.flip.exposure, "0");
    add_text(app, {"--difference", "FILE", "a picture: red where IMAGE is brighter, blue where darker"},
             options.difference_file);
    app.add_flag("--json", options.json, "the numbers as a JSON object");
    add_threshold_options(app, options.max);
    add_block_options(app, options);
}

/// Says so on stderr when `value` is above `limit`, or no number at all. Returns whether it passes.
bool within(std::string_view what, double value, const std::optional<double>& limit) {
    if (!limit || value <= *limit) return true;
    print_line(fmt::format("relumine compare: {}: expected at most {}, found {:.6g}", what, *limit, value));
    return false;
}

bool all_finite(std::size_t non_finite_pixels) {
    return within("pixels that are not finite", static_cast<double>(non_finite_pixels), 0);
}

Json comparison_json(const Comparison& c, double flip, int block_size) {
    return {{"compared_pixels", c.compared_pixels},
            {"non_finite_pixels", c.non_finite_pixels},
            {"relative_l1", c.relative_l1},
            {"rmse", c.rmse},
            {"relmse", c.relmse},
            {"mean_ratio", c.mean_ratio},
            {"max_abs_difference", c.max_abs_difference},
            {"flip", flip},
            {"block_size", block_size},
            {"blocks", c.blocks},
            {"block_difference_median", c.block_difference_median},
            {"block_difference_p95", c.block_difference_p95},
            {"block_difference_max", c.block_difference_max},
            {"blocks_within_tolerance", c.blocks_within_tolerance},
            {"worst_block", {c.worst_block.x0, c.worst_block.y0, c.worst_block.x1, c.worst_block.y1}}};
}

std::string comparison_text(const Comparison& c, double flip, const CompareOptions& options) {
    std::string text;
    text += fmt::format("relative L1    {:.6g}\n", c.relative_l1);
    text += fmt::format("RMSE           {:.6g}\n", c.rmse);
    text += fmt::format("relMSE         {:.6g}\n", c.relmse);
    text += fmt::format("mean ratio     {:.6g}\n", c.mean_ratio);
    text += fmt::format("FLIP           {:.6g}\n", flip);
    text += fmt::format("worst pixel    {:.6g} off\n", c.max_abs_difference);
    text += fmt::format(
        "blocks of {:<4} {:.4g} off in the median, {:.4g} at 95 %, {:.4g} at worst (pixels {},{} to {},{}); "
        "{:.2f} % of {} within {:g}\n",
        options.block_size, c.block_difference_median, c.block_difference_p95, c.block_difference_max,
        c.worst_block.x0, c.worst_block.y0, c.worst_block.x1, c.worst_block.y1,
        100 * c.blocks_within_tolerance, c.blocks, options.block_tolerance);
    return text;
}

bool passes(const Comparison& c, double flip, const Thresholds& max) {
    bool pass = all_finite(c.non_finite_pixels);
    pass &= within("relative L1", c.relative_l1, max.relative_l1);
    pass &= within("RMSE", c.rmse, max.rmse);
    pass &= within("relMSE", c.relmse, max.relmse);
    pass &= within("|mean ratio - 1|", std::abs(c.mean_ratio - 1), max.mean);
    pass &= within("worst block", c.block_difference_max, max.block);
    pass &= within("FLIP", flip, max.flip);
    return pass;
}

bool compare_pixels(const Options& options, const Image& image, const Image& reference) {
    const Comparison c = compare_images(image, reference, options.compare);
    const double seen = flip(image, reference, options.flip).mean;
    if (!options.difference_file.empty())
        write_image(signed_difference(image, reference), options.difference_file);
    print(options.json ? json_text(comparison_json(c, seen, options.compare.block_size), 2) + "\n"
                       : comparison_text(c, seen, options.compare));
    return passes(c, seen, options.max);
}

Json blocks_json(const BlockComparison& c) {
    return {{"block_size", c.block_size},
            {"columns", c.columns},
            {"rows", c.rows},
            {"included", c.included},
            {"excluded", c.excluded},
            {"failing", c.failing},
            {"non_finite_pixels", c.non_finite_pixels},
            {"mean_ratio", c.mean_ratio},
            {"mean_relative_difference", c.mean_relative_difference},
            {"max_relative_difference", c.max_relative_difference},
            {"worst_of_allowed", c.worst_of_allowed},
            {"worst_column", c.worst_column},
            {"worst_row", c.worst_row},
            {"worst_channel", c.worst_channel},
            {"worst_sigmas", c.worst_sigmas},
            {"passes", c.passes()}};
}

std::string blocks_text(const BlockComparison& c) {
    std::string text;
    text += fmt::format("blocks         {} x {} of {} pixels a side; {} included, {} left out\n", c.columns,
                        c.rows, c.block_size, c.included, c.excluded);
    text += fmt::format("mean ratio     {:.6g}\n", c.mean_ratio);
    text += fmt::format("difference     {:.4g} on average, {:.4g} at worst\n", c.mean_relative_difference,
                        c.max_relative_difference);
    text += fmt::format(
        "worst block    column {}, row {}, {}: {:.3g} of what is allowed, {:.3g} standard errors\n",
        c.worst_column, c.worst_row,
        std::string_view("RGB").substr(static_cast<std::size_t>(c.worst_channel), 1), c.worst_of_allowed,
        c.worst_sigmas);
    text += fmt::format("out of bounds  {}\n", c.failing);
    return text;
}

bool passes(const BlockComparison& c, const Thresholds& max) {
    bool pass = all_finite(c.non_finite_pixels);
    pass &= within("blocks out of tolerance", static_cast<double>(c.failing), 0);
    pass &= within("|mean ratio - 1|", std::abs(c.mean_ratio - 1), max.mean);
    pass &= within("worst block", c.max_relative_difference, max.block);
    if (c.included > 0) return pass;
    print_line("relumine compare: blocks: expected at least one to compare, found that all are left out");
    return false;
}

std::optional<Image> read_optional(const std::string& file) {
    return file.empty() ? std::nullopt : std::optional(read_image(file));
}

/// The image's layer "variance" as a picture of its own; empty where it has none.
std::optional<Image> variance_of(const Image& image) {
    const Layer* layer = image.layer("variance");
    if (!layer) return std::nullopt;
    Image variance = image;
    variance.layers = {{"", layer->channels, layer->pixels}};
    return variance;
}

bool compare_with_blocks(const Options& options, const Image& image, const Image& reference) {
    const std::optional<Image> error = read_optional(options.reference_se_file);
    const std::optional<Image> variance = variance_of(image);
    const BlockComparison c = compare_blocks(image, reference, options.tolerance, error ? &*error : nullptr,
                                             variance ? &*variance : nullptr);
    print(options.json ? json_text(blocks_json(c), 2) + "\n" : blocks_text(c));
    return passes(c, options.max);
}

}  // namespace

ExitCode run_compare(const Arguments& arguments) {
    CLI::App app("Tells how far IMAGE is from REFERENCE.", "relumine compare");
    Options options;
    add_options(app, options);
    app.footer(
        "Exit codes: 0 within all thresholds given; 1 not, or pixels that are not finite, or bad input; 2 "
        "bad usage.");
    if (!parse(app, arguments)) return ExitCode::done;

    if (!options.difference_file.empty()) check_pictures("--difference", {options.difference_file});
    const Image image = read_image(options.image);
    const Image reference = read_image(options.reference);
    const bool pass = options.reference_blocks ? compare_with_blocks(options, image, reference)
                                               : compare_pixels(options, image, reference);
    return pass ? ExitCode::done : ExitCode::failed;
}

}  // namespace relumine::cli
