// SPDX-License-Identifier: Apache-2.0
// Whole pbrt scenes, rendered: cameras, known radiances, and the same scene built in memory.
#include <gtest/gtest.h>

#include "base/equal_area.hpp"
#include "base/hash.hpp"
#include "image/byte_image.hpp"
#include "integrators/camera_rays.hpp"
#include "scene/test_files.hpp"
#include "tests/render_support.hpp"

namespace relumine {
namespace {

using test::TempFolder;
using testing::mean_of;

Scene load(const std::string& text) {
    const TempFolder folder;
    return load_scene(folder.write("scene.pbrt", text));
}

const std::string square =  // in the plane z = 0, facing −Z
    "Shape \"trianglemesh\" \"point3 P\" [-9 -9 0  9 -9 0  9 9 0  -9 9 0] \"integer indices\" [0 2 1 0 3 "
    "2]\n";

/// Where the camera sees a point: the pixel whose ray meets it.
Point2 pixel_of(const Camera& camera, Vec3 point) {
    const CameraRays rays(camera, camera.width, camera.height);
    Point2 best;
    float least = infinity;
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            const Point2 pixel{static_cast<float>(x), static_cast<float>(y)};  // corners of pixels
            const Ray ray = rays.through(pixel);
            const Vec3 to = point - ray.origin;
            const float distance =
                length(cross(to, ray.direction.v)) + (dot(to, ray.direction.v) < 0 ? 1e9f : 0);
            if (distance < least) {
                least = distance;
                best = pixel;
            }
        }
    return best;
}

Point2 seen_at(const std::string& before_camera, const std::string& camera, const std::string& size,
               Vec3 point) {
    const Scene scene =
        load(before_camera + "\nCamera " + camera + "\nFilm \"rgb\" " + size + "\nWorldBegin\n" + square);
    return pixel_of(scene.data().cameras.at(0), point);
}

const std::string wide = "\"integer xresolution\" 200 \"integer yresolution\" 100";
const std::string high = "\"integer xresolution\" 100 \"integer yresolution\" 200";
const std::string ahead = "LookAt 0 0 -5  0 0 0  0 1 0";

TEST(PbrtCamera, XIsToTheRightAndYUpwards) {  // the field of view spans the shorter axis
    EXPECT_EQ(seen_at(ahead, "\"perspective\" \"float fov\" 90", wide, {1, 0, 0}), (Point2{110, 50}));
    EXPECT_EQ(seen_at(ahead, "\"perspective\" \"float fov\" 90", wide, {0, 2, 0}), (Point2{100, 30}));
    EXPECT_EQ(seen_at(ahead, "\"perspective\" \"float fov\" 90", high, {1, 0, 0}), (Point2{60, 100}));
}

TEST(PbrtCamera, ScaleBeforeLookAtMirrorsThePicture) {
    EXPECT_EQ(seen_at("Scale -1 1 1 " + ahead, "\"perspective\"", wide, {1, 0, 0}), (Point2{90, 50}));
}

TEST(PbrtCamera, TransformsAreOfTheWorldToTheCamera) {
    EXPECT_EQ(seen_at("Translate 0 0 5", "\"perspective\"", wide, {1, 0, 0}), (Point2{110, 50}));
    EXPECT_EQ(seen_at("LookAt 5 0 0  0 0 0  0 1 0", "\"perspective\"", wide, {0, 0, 1}), (Point2{110, 50}));
}

TEST(PbrtCamera, OrthographicScreensAreInUnitsOfTheScene) {
    EXPECT_EQ(seen_at(ahead, "\"orthographic\"", wide, {1, 0.5f, 0}), (Point2{150, 25}));
    EXPECT_EQ(seen_at(ahead, "\"orthographic\" \"float screenwindow\" [-4 4 -2 2]", wide, {1, 1, 0}),
              (Point2{125, 25}));
}

TEST(PbrtCamera, ScreenWindowsShiftAndStretch) {
    const std::string right = "\"perspective\" \"float fov\" 90 \"float screenwindow\" [0 2 -1 1]";
    EXPECT_EQ(seen_at(ahead, right, wide, {1, 0, 0}), (Point2{20, 50}));
    EXPECT_EQ(seen_at(ahead, right, wide, {5, 1, 0}), (Point2{100, 40}));
    const std::string upper = "\"perspective\" \"float fov\" 90 \"float screenwindow\" [-2 2 0 1]";
    EXPECT_EQ(seen_at(ahead, upper, wide, {1, 1, 0}), (Point2{110, 80}));
}

RenderSettings one_sample() {
    RenderSettings settings;
    settings.method = "path";
    settings.samples_per_pixel = 1;
    return settings;
}

std::array<float, 3> middle(const Image& image) { return image.rgb(image.width / 2, image.height / 2); }

const std::string small_view =
    "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n"
    "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 6\nWorldBegin\n";

TEST(PbrtRender, SizeAndCropComeFromTheFilm) {
    const Scene scene = load(
        "Camera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 20 \"integer yresolution\" 10 "
        "\"float cropwindow\" [.5 1 .2 .6]\nWorldBegin\nTranslate 0 0 5\n"
        + square);
    const Image image = render(scene, one_sample());
    EXPECT_EQ(image.frame_width, 20);
    EXPECT_EQ(image.frame_height, 10);
    EXPECT_EQ(image.window, (PixelRect{10, 2, 20, 6}));
    RenderSettings other = one_sample();
    other.width = other.height = 12;
    EXPECT_EQ(render(scene, other).width, 12);
}

TEST(PbrtRender, EmittersShowTheirRadianceOnTheirSide) {
    const std::string light = "AreaLightSource \"diffuse\" \"rgb L\" [3 2 1] \"float scale\" 2";
    EXPECT_EQ(middle(render(load(small_view + light + '\n' + square), one_sample())),
              (std::array{6.0f, 4.0f, 2.0f}));
    EXPECT_EQ(middle(render(load(small_view + light + " ReverseOrientation\n" + square), one_sample()))[0],
              0);
    EXPECT_EQ(
        middle(render(load(small_view + light + " \"bool twosided\" true ReverseOrientation\n" + square),
                      one_sample()))[0],
        6);
}

TEST(PbrtRender, PointAndDistantLightsGiveKnownRadiance) {  // ρ/π·I/d² and ρ/π·E
    RenderSettings settings = one_sample();
    settings.crop = PixelRect{4, 3, 5, 4};
    settings.pixel_sampling = "center";
    const std::string matte = "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n" + square;
    const std::string on_axis =
        "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 1\n"
        "Film \"rgb\" \"integer xresolution\" 9 \"integer yresolution\" 7\nWorldBegin\n";
    const auto radiance = [&](const std::string& light) {
        return render(load(on_axis + light + '\n' + matte), settings).rgb(0, 0)[0];
    };
    EXPECT_NEAR(radiance("LightSource \"point\" \"rgb I\" [12.566 1 1] \"point3 from\" [0 0 -2]"), 0.5f,
                1e-3f);
    EXPECT_NEAR(radiance("LightSource \"distant\" \"rgb L\" [3.1416 1 1]"), 0.5f, 1e-3f);  // towards +Z
    EXPECT_EQ(radiance("LightSource \"distant\" \"point3 to\" [0 0 -1]"), 0);
    EXPECT_NEAR(
        radiance(
            "LightSource \"spot\" \"rgb I\" [12.566 1 1] \"point3 from\" [0 0 -2] \"point3 to\" [0 0 0]"),
        0.5f, 1e-3f);
    EXPECT_NEAR(radiance("LightSource \"infinite\" \"rgb L\" [1 1 1]"), 0.5f, 1e-3f);
}

std::string pfm(int width, int height, const std::vector<float>& rgb) {  // bottom row first
    return "PF\n" + std::to_string(width) + ' ' + std::to_string(height) + "\n-1\n" + test::bytes_of(rgb);
}

TEST(PbrtRender, EqualAreaMapsReturnThroughTheSphericalCamera) {
    constexpr int side = 8, texels = 4, pixels = side * texels;
    std::vector<float> rgb;
    for (int y = side - 1; y >= 0; --y)
        for (int x = 0; x < side; ++x)
            for (const int c : {x, y, x + y}) rgb.push_back(static_cast<float>(c) / side + 0.1f);
    const TempFolder folder;
    (void)folder.write("sky.pfm", pfm(side, side, rgb));
    // The camera's Y axis is the light's Z axis.
    const Scene scene = load_scene(folder.write(
        "scene.pbrt", "Camera \"spherical\"\nFilm \"rgb\" \"integer xresolution\" " + std::to_string(pixels)
                          + " \"integer yresolution\" " + std::to_string(pixels)
                          + "\nWorldBegin\nAttributeBegin\nTransform [1 0 0 0  0 0 1 0  0 1 0 0  0 0 0 1]\n"
                            "LightSource \"infinite\" \"string filename\" \"sky.pfm\"\nAttributeEnd\n"
                            "Translate 1e5 0 0\n"
                          + square));
    RenderSettings settings = one_sample();
    settings.samples_per_pixel = 16;
    const Image image = render(scene, settings);
    double error = 0;
    for (int y = 0; y < pixels; ++y)
        for (int x = 0; x < pixels; ++x) {
            const auto [r, g, b] = image.rgb(x, y);
            error += std::abs(r - (static_cast<float>(x / texels) / side + 0.1f)) / (pixels * pixels);
            error += std::abs(g - (static_cast<float>(y / texels) / side + 0.1f)) / (pixels * pixels);
        }
    EXPECT_LT(error, 0.03);  // texels' edges alone: a wrong orientation gives 0.5
}

TEST(PbrtRender, PatternedLightsThrowTheirPictures) {
    // A projector beside the camera shows its picture upright, as pbrt turns it: rows downwards, +X to the
    // right.
    const TempFolder folder;
    (void)folder.write(
        "p.pfm", pfm(2, 2, {0, 0, 4, 9, 0, 0, 1, 1, 1, 0, 6, 0}));  // lower row blue, red; upper white, green
    const std::string view =
        "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n"
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nWorldBegin\n";
    const auto picture = [&](const std::string& light) {
        return render(load_scene(folder.write("scene.pbrt", view + light + '\n' + square)), one_sample());
    };
    const Image thrown = picture(
        "AttributeBegin Translate 0 0 -5 LightSource \"projection\" \"string filename\" "
        "\"p.pfm\" \"float fov\" 60 AttributeEnd");
    EXPECT_NEAR(thrown.rgb(1, 1)[0] / thrown.rgb(1, 1)[2], 1, 1e-3f);  // upper left: white
    EXPECT_EQ(thrown.rgb(6, 1)[0], 0);                                 // upper right: green
    EXPECT_GT(thrown.rgb(6, 1)[1], 0);
    EXPECT_EQ(thrown.rgb(1, 6)[0], 0);  // lower left: blue
    EXPECT_GT(thrown.rgb(1, 6)[2], 0);
    EXPECT_GT(thrown.rgb(6, 6)[0], 0);  // lower right: red
    EXPECT_EQ(thrown.rgb(6, 6)[2], 0);
    // Goniometric: the picture's middle is +Y of the light (pbrt swaps Y and Z), its lower half +Z.
    (void)folder.write("g.pfm", pfm(2, 2, {3, 3, 3, 3, 3, 3, 0, 0, 0, 0, 0, 0}));  // lower row alone
    const auto at = [&](const std::string& turn) {
        return middle(
            picture("AttributeBegin Translate 0 0 -5 " + turn
                    + " LightSource \"goniometric\" \"string filename\" \"g.pfm\" AttributeEnd"))[0];
    };
    EXPECT_GT(at(""), 0);
    EXPECT_EQ(at("Rotate 180 0 1 0"), 0);
}

TEST(PbrtRender, AgreesWithTheSameSceneBuiltInMemory) {
    const Scene file = load(
        "LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n"
        "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\nWorldBegin\n"
        "LightSource \"point\" \"rgb I\" [30 20 10] \"point3 from\" [1 2 3]\n"
        "LightSource \"infinite\" \"rgb L\" [.5 .5 .5]\n"
        "Material \"diffuse\" \"rgb reflectance\" [.2 .4 .6]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-2 -1 0  2 -1 0  0 2 0  -2 -1 2  2 -1 2] "
        "\"integer indices\" [0 1 2  0 4 1  0 3 4]\n");
    SceneBuilder builder;
    MaterialDescription matte;
    matte.base_color = {.2f, .4f, .6f};
    matte.specular = 0;
    const std::vector<std::array<float, 3>> positions{
        {-2, -1, 0}, {2, -1, 0}, {0, 2, 0}, {-2, -1, 2}, {2, -1, 2}};
    const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 4, 1}, {0, 3, 4}};
    MeshDescription mesh;
    mesh.positions = positions;
    mesh.triangles = triangles;
    mesh.material = builder.add_material(matte);
    builder.add_instance(builder.add_mesh(mesh));
    builder.add_light(PointLightDescription{{1, 2, 3}, {30, 20, 10}});
    const std::vector<float> sky(6, 0.5f);
    builder.set_environment(2, 1, sky);
    CameraDescription camera;
    // pbrt's coordinates are left-handed: from +Z its camera has world +X at the left of the picture
    camera.world_from_camera = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1};
    camera.vertical_fov = 40 * 3.14159265358979 / 180;
    builder.add_camera(camera);
    RenderSettings settings = one_sample();
    settings.samples_per_pixel = 64;
    settings.width = settings.height = 16;
    const Image a = render(file, settings), b = render(builder.build(), settings);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(a.rgb(x, y)[c], b.rgb(x, y)[c], 1e-3f) << x << ' ' << y;
}

/// What a diffuse scene reflects and where it is, seen from −Z over x and y from −2 to 2.
struct Painted {
    std::vector<float> color;  // red
    std::vector<Vec3> position;
};

constexpr int painted_side = 32;

Painted painted(const TempFolder& folder, const std::string& world) {
    const Scene scene =
        load_scene(folder.write("scene.pbrt",
                                "LookAt 0 0 -9  0 0 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" "
                                "[-2 2 -2 2]\nWorldBegin\nLightSource \"infinite\"\n"
                                    + world));
    RenderSettings settings = one_sample();
    settings.width = settings.height = painted_side;
    settings.pixel_sampling = "center";
    settings.aovs = {"albedo", "position"};
    const Image image = render(scene, settings);
    const auto& colors = image.layer("albedo")->pixels;
    const auto& positions = image.layer("position")->pixels;
    Painted seen;
    for (std::size_t i = 0; i < colors.size(); i += 3) {
        seen.color.push_back(colors[i]);
        seen.position.push_back({positions[i], positions[i + 1], positions[i + 2]});
    }
    return seen;
}

constexpr int grain = 8;  // texels along each side of the picture

std::uint8_t grain_value(int x, int y) {
    return static_cast<std::uint8_t>(40 + hash(static_cast<std::uint64_t>(y * grain + x), 7) % 200);
}

/// A linear picture named p.png of grains, read without interpolation.
std::string grain_texture(const TempFolder& folder, const std::string& mapping) {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < grain; ++y)
        for (int x = 0; x < grain; ++x) rgb.insert(rgb.end(), 3, grain_value(x, y));
    const auto png = encode_png(grain, grain, rgb);
    (void)folder.write("p.png", {reinterpret_cast<const char*>(png.data()), png.size()});
    return "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"p.png\" \"string encoding\" "
           "\"linear\" "
           "\"string filter\" \"point\" "
           + mapping + "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n";
}

/// The grain at (s, t), t upwards; nothing near the border of one.
std::optional<float> grain_at(double s, double t) {
    const double x = (s - std::floor(s)) * grain, y = (1 - (t - std::floor(t))) * grain;
    const auto near_border = [](double c) { return std::abs(c - std::round(c)) < 1e-3; };
    if (near_border(x) || near_border(y)) return {};
    return static_cast<float>(grain_value(static_cast<int>(x), static_cast<int>(y))) / 255;
}

/// Whether `coordinates(position)` say what every pixel shows.
template <typename Coordinates>
void expect_painted(const Painted& seen, const Coordinates& coordinates) {
    int compared = 0;
    for (std::size_t i = 0; i < seen.color.size(); ++i) {
        const auto [s, t] = coordinates(seen.position[i]);
        const std::optional<float> wanted = grain_at(s, t);
        if (!wanted) continue;
        ASSERT_NEAR(seen.color[i], *wanted, 1e-3f) << i % painted_side << ' ' << i / painted_side;
        ++compared;
    }
    EXPECT_GT(compared, painted_side * painted_side * 9 / 10);
}

constexpr double turn = 2 * 3.14159265358979323846;

TEST(PbrtMapping, SphericalAndCylindricalActAtEveryPoint) {  // of two large triangles
    const TempFolder folder;
    const std::string move = "AttributeBegin Translate .3 .2 -.7\n", back = "AttributeEnd\n";
    const auto world = [&](const std::string& kind) {
        // what is declared within an attribute keeps its transform and is known outside
        const std::string texture = grain_texture(folder, "\"string mapping\" \"" + kind + "\"");
        const std::size_t end = texture.find('\n') + 1;
        return move + texture.substr(0, end) + back + texture.substr(end) + square;
    };
    expect_painted(painted(folder, world("spherical")), [](Vec3 p) {
        const double x = double{p.x} - .3, y = double{p.y} - .2, z = double{p.z} + .7;
        const double around = std::atan2(y, x) / turn;
        return std::pair{2 * std::acos(z / std::hypot(x, y, z)) / turn, around < 0 ? around + 1 : around};
    });
    expect_painted(painted(folder, world("cylindrical")), [](Vec3 p) {
        const double x = double{p.x} - .3, y = double{p.y} - .2, z = double{p.z} + .7;
        return std::pair{0.5 + std::atan2(y, x) / turn, z};
    });
}

TEST(PbrtMapping, InstancesAreMappedWhereTheyStand) {
    const TempFolder folder;
    const std::string object =
        "ObjectBegin \"o\"\nShape \"trianglemesh\" \"point3 P\" [-2 -1 0  2 -1 0  2 1 0  -2 1 0] "
        "\"integer indices\" [0 2 1 0 3 2]\nObjectEnd\n"
        "AttributeBegin Translate 0 1 0 ObjectInstance \"o\" AttributeEnd\n"
        "AttributeBegin Translate 0 -1 0 Scale -1 1 1 ObjectInstance \"o\" AttributeEnd\n";
    const std::string planar =
        "\"string mapping\" \"planar\" \"vector3 v1\" [.4 .1 0] \"vector3 v2\" [0 .3 0] \"float udelta\" .2";
    expect_painted(painted(folder, grain_texture(folder, planar) + object), [](Vec3 p) {
        return std::pair{.2 + .4 * double{p.x} + .1 * double{p.y}, .3 * double{p.y}};
    });
}

TEST(PbrtMapping, DirectionMixesByWhereSurfacesFace) {
    const TempFolder folder;
    const std::string mix =
        "Texture \"m\" \"spectrum\" \"directionmix\" \"rgb tex1\" [.8 .8 .8] \"rgb tex2\" [.1 .1 .1] "
        "\"vector3 dir\" [0 3 0]\nMaterial \"diffuse\" \"texture reflectance\" \"m\"\n";
    const Painted ball = painted(folder, mix + "Shape \"sphere\" \"float radius\" 2.9");
    for (std::size_t i = 0; i < ball.color.size(); ++i) {
        const float facing = std::abs(ball.position[i].y) / 2.9f;
        ASSERT_NEAR(ball.color[i], .1f + .7f * facing, 2e-3f) << i;
    }
    // A mesh faces as its triangles do, whatever its vertices' normals say; "dir" is of the texture's space.
    const std::string turned = "Rotate 60 1 0 0\n";
    const std::string slope =
        "Shape \"trianglemesh\" \"point3 P\" [-9 -9 0  9 -9 0  9 9 0  -9 9 0] \"integer indices\" [0 2 1 0 3 "
        "2] "
        "\"normal N\" [0 -.6 -.8 0 -.6 -.8 0 -.6 -.8 0 -.6 -.8]\n";
    for (const float c : painted(folder, mix + turned + slope).color)
        ASSERT_NEAR(c, .1f + .7f * .8660254f, 1e-3f);
    for (const float c : painted(folder, turned + mix + slope).color) ASSERT_NEAR(c, .1f, 1e-3f);
}

TEST(PbrtMapping, DirectionMixesOfPictures) {
    const TempFolder folder;
    std::string texture = grain_texture(
        folder, "\"string mapping\" \"planar\" \"vector3 v1\" [.3 0 0] \"vector3 v2\" [0 .3 0]");
    texture +=
        "Texture \"m\" \"spectrum\" \"directionmix\" \"texture tex1\" \"t\" \"rgb tex2\" [1 1 1] \"vector3 "
        "dir\" [0 0 1]\n"
        "Material \"diffuse\" \"texture reflectance\" \"m\"\nRotate 60 1 0 0\n";
    Painted seen = painted(folder, texture + square);
    for (float& c : seen.color) c = 2 * c - 1;  // half of it is white
    expect_painted(seen, [](Vec3 p) { return std::pair{.3 * double{p.x}, .3 * double{p.y}}; });
}

TEST(PbrtRender, ThinLensesBlurWhatIsOutOfFocus) {
    const auto edge = [&](const std::string& lens) {  // an edge in the middle of the picture
        const Scene scene = load("LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 20 " + lens
                                 + "\nFilm \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 8\nWorldBegin\n"
                                   "AreaLightSource \"diffuse\" \"bool twosided\" true\n"
                                   "Shape \"trianglemesh\" \"point3 P\" [0 -9 0  9 -9 0  9 9 0  0 9 0] "
                                   "\"integer indices\" [0 1 2 0 2 3]\n");
        RenderSettings settings = one_sample();
        settings.samples_per_pixel = 64;
        return render(scene, settings).rgb(14, 4)[0];  // left of the edge
    };
    EXPECT_EQ(edge(""), 0);
    EXPECT_EQ(edge("\"float lensradius\" .5 \"float focaldistance\" 5"), 0);
    EXPECT_GT(edge("\"float lensradius\" .5 \"float focaldistance\" 2"), 0.1f);
}

TEST(PbrtRender, FurnaceOfTransmittingAndCoatedSurfaces) {  // what is reflected and transmitted is 1 in all
    for (const char* material :
         {"\"diffusetransmission\" \"rgb reflectance\" [.5 .5 .5] \"rgb transmittance\" [.5 .5 .5]",
          "\"dielectric\"", "\"thindielectric\""}) {
        const Image image = render(load(small_view + "LightSource \"infinite\"\nMaterial " + material
                                        + "\nShape \"sphere\" \"float radius\" 1.5\n"),
                                   [] {
                                       auto s = one_sample();
                                       s.samples_per_pixel = 256;
                                       return s;
                                   }());
        EXPECT_NEAR(mean_of(image), 1, 0.01) << material;
    }
    // pbrt's coat over white absorbs a little: its path stops after ten events
    const Image coated = render(load(small_view
                                     + "LightSource \"infinite\"\nMaterial \"coateddiffuse\" "
                                       "\"rgb reflectance\" [1 1 1] \"float thickness\" 0 \"integer "
                                       "maxdepth\" 1000\n"
                                     + square),
                                [] {
                                    auto s = one_sample();
                                    s.samples_per_pixel = 1024;
                                    return s;
                                }());
    EXPECT_NEAR(mean_of(coated), 1, 0.01);
}

TEST(PbrtRender, TheCornellBoxIsThatOfItsGltf) {
    RenderSettings settings = one_sample();
    settings.width = settings.height = 32;
    settings.samples_per_pixel = 4;
    const auto gltf = testing::block_estimates(testing::project_scene("cornell.glb"), settings, 16, 8);
    const auto pbrt = testing::block_estimates(testing::project_scene("pbrt/cornell.pbrt"), settings, 16, 8);
    EXPECT_GT(testing::agreement_p(gltf, pbrt), 1e-6);
    EXPECT_LT(testing::agreement_p(gltf, pbrt, 1.1), 1e-6);  // a bias would show
}

}  // namespace
}  // namespace relumine
