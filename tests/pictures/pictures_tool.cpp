// SPDX-License-Identifier: Apache-2.0
// Makes references anew, shows them beside the old ones, and writes docs/validation.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>

#include "relumine/compare.hpp"
#include "relumine/error.hpp"
#include "tests/pictures/reference.hpp"
#include "tests/pictures/sheet.hpp"

namespace relumine::pictures {
namespace {

namespace fs = std::filesystem;

struct UpdateOptions {
    std::vector<std::string> names;  // empty: all
    int samples = 0;                 // 0: sixteen times those of the test
    std::string out = "out/pictures";
    bool apply = false;
};

/// One line on how the new reference differs from the old one.
std::string difference_text(const Reference& now, const Reference& old) {
    const Fit f = fit(now.mean, now.samples, old);
    const Comparison c = compare_images(now.mean, old.mean);
    return fmt::format("worst z {:.1f} (p {:.2g}), mean ratio {:.4f}, FLIP {:.4f}", f.worst_z, f.p,
                       c.mean_ratio, flip(now.mean, old.mean).mean);
}

void update(const PictureCase& picture, const UpdateOptions& options) {
    const std::string path = reference_path(picture);
    const Reference now =
        make_reference(picture, options.samples > 0 ? options.samples : 16 * picture.samples);
    std::optional<Reference> old;
    if (fs::exists(path)) old = read_reference(path);
    const std::string shown = options.out + "/" + picture.name + ".png";
    write_image(sheet_of({{old ? old->mean : now.mean, now.mean}}, 1, 8), shown);
    fmt::print("{}: {}; old, new, difference: {}\n", picture.name,
               old ? difference_text(now, *old) : "no reference before", shown);
    std::fflush(stdout);
    if (options.apply) write_reference(now, path);
}

void run_update(const UpdateOptions& options) {
    fs::create_directories(options.out);
    fs::create_directories(fs::path(reference_path(picture_cases().front())).parent_path());
    if (options.names.empty())
        for (const PictureCase& picture : picture_cases()) update(picture, options);
    for (const std::string& name : options.names) update(find_picture(name), options);
    if (!options.apply) fmt::print("nothing was replaced; look at the pictures, then add --apply\n");
}

/// A table row and what it shows.
struct Row {
    std::string text;
    Triple pictures;
};

Row path_row(const PictureCase& picture) {
    const Reference reference = read_reference(reference_path(picture));
    const Image image = render_picture(picture, load_picture_scene(picture), path_settings(picture));
    const Fit f = fit(image, picture.samples, reference);
    const double ratio = compare_images(image, reference.mean).mean_ratio;
    return {fmt::format("| {} | {} | {} | {:.1f} | {:.2g} | {:+.2f} ± {:.2f} % | {:.3f} |\n", picture.name,
                        picture.shows, picture.samples, f.worst_z, f.p, 100 * (ratio - 1), 100 * f.mean_error,
                        flip(image, reference.mean).mean),
            {reference.mean, image}};
}

Row method_row(const MethodCase& method) {
    const PictureCase& picture = find_picture(method.picture);
    const Reference reference = read_reference(reference_path(picture));
    const Image image = render(load_picture_scene(picture), method_settings(picture, method.settings));
    const Comparison c = compare_images(image, reference.mean, {.block_size = 8});
    const Tolerance& t = method.tolerance;
    return {
        fmt::format("| {} | {} | {:+.2f} % ({:g} %) | {:.1f} % ({:g} %) | {:.3f} ({:g}) |\n", picture.name,
                    method.label, 100 * (c.mean_ratio - 1), 100 * t.mean, 100 * c.block_difference_max,
                    100 * t.block, flip(image, reference.mean).mean, t.flip),
        {reference.mean, image}};
}

constexpr int columns = 4;

std::string document(const std::vector<Row>& paths, const std::vector<Row>& methods) {
    std::string text =
        "# Validation\n\n"
        "Written by `scripts/validate`; do not edit. Tiny scenes (48 × 32 pixels), each of a feature or two, "
        "against "
        "stored references\nthat `path` converged to with other seeds. `relumine_tests "
        "--gtest_filter='*Picture*'` repeats the comparison and changes scenes to see\nthat it fails then. "
        "`scripts/update-pictures` makes references anew, shows old, new and difference, and replaces "
        "nothing "
        "without `--apply`.\n\n"
        "## `path`\n\n"
        "z: the worst of all blocks of 4 × 4 pixels and of the picture's mean, channel by channel, in "
        "standard "
        "errors that the stored\nvariance predicts; p: the chance of one as bad or worse (Šidák over these "
        "comparisons); a test fails below 1e-4, so by chance once\nin 10 000 pictures. A change of "
        "brightness of more than about five times the error of the mean is caught; for every picture a\ntest "
        "proves that 3 % is.\n\n"
        "| picture | shows | samples | z | p | mean | FLIP |\n|---|---|--:|--:|--:|--:|--:|\n";
    for (const Row& row : paths) text += row.text;
    text += fmt::format(
        "\nIn the table's order, {} in a row: reference, picture, difference (red: brighter; full colour at "
        "a "
        "fifth of the reference's mean).\n\n![Reference, picture, "
        "difference](images/validation-path.png)\n\n",
        columns);
    text +=
        "## The other methods\n\n"
        "Against the same references, so biased methods are held to the truth and not to themselves. Behind "
        "each figure stands the tolerance\nof the test. They include noise: renders are short. Mean: of the "
        "picture; block: the worst of 8 × 8 pixels; FLIP: at exposure 0, 67\npixels per degree.\n\n"
        "| picture | method | mean | block | FLIP |\n|---|---|--:|--:|--:|\n";
    for (const Row& row : methods) text += row.text;
    text += "\n![Reference, picture, difference](images/validation-methods.png)\n";
    return text;
}

void write_sheet(const std::vector<Row>& rows, const std::string& path) {
    std::vector<Triple> triples;
    for (const Row& row : rows) triples.push_back(row.pictures);
    write_image(sheet_of(triples, columns, 2), path);
}

void run_validate(const std::string& folder) {
    std::vector<Row> paths, methods;
    for (const PictureCase& picture : picture_cases()) paths.push_back(path_row(picture));
    for (const MethodCase& method : method_cases()) methods.push_back(method_row(method));
    write_sheet(paths, folder + "/images/validation-path.png");
    write_sheet(methods, folder + "/images/validation-methods.png");
    std::ofstream(folder + "/validation.md") << document(paths, methods);
}

}  // namespace
}  // namespace relumine::pictures

int main(int argc, char** argv) {
    using namespace relumine::pictures;
    CLI::App app("The regression pictures: references made anew, and docs/validation.md.",
                 "relumine_pictures");
    app.require_subcommand(1);
    UpdateOptions options;
    CLI::App& update = *app.add_subcommand("update", "renders references and shows them beside the old ones");
    update.add_option("NAME", options.names, "pictures of tests/pictures/cases.cpp; all by default");
    update.add_option("--samples", options.samples, "camera samples per pixel; 16 times those of the test");
    update.add_option("--out", options.out, "folder for the pictures; out/pictures");
    update.add_flag("--apply", options.apply, "replaces the stored references");
    std::string folder = "docs";
    CLI::App& validate = *app.add_subcommand("validate", "writes validation.md and its pictures");
    validate.add_option("FOLDER", folder, "docs by default");
    CLI11_PARSE(app, argc, argv);
    try {
        if (update.parsed()) run_update(options);
        if (validate.parsed()) run_validate(folder);
    } catch (const std::exception& error) {
        fmt::print(stderr, "relumine_pictures: {}\n", error.what());
        return 1;
    }
    return 0;
}
