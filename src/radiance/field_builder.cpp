// SPDX-License-Identifier: Apache-2.0
// Elements in generations: surveyed, traced, linked; then their light.
#include "radiance/field_builder.hpp"

#include <mutex>

#include "base/executor.hpp"
#include "radiance/caustic_map.hpp"
#include "radiance/field_scale.hpp"
#include "radiance/field_survey.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t seed_rays = 64;   // that a seed traces each time
constexpr std::uint32_t seed_rounds = 4;  // later ones find what cells were divided into
constexpr std::size_t generation = 256;   // elements whose rays are traced before their links are made
constexpr int divided_part = 4;           // elements that smaller ones stand for trace so much fewer rays
constexpr int smooth_part = 2;            // likewise those whose light is blended with that around
constexpr float smooth_from = 0.5f;       // smoothness of these

constexpr double most_by_chance = 8;         // a ray's find along lobes, over the mean light of elements
constexpr float most_found_by_chance = 256;  // a gather ray's, over their mean radiance

class FieldBuilder {
  public:
    FieldBuilder(const Transport& t, std::span<const FieldSeed> seeds, const FieldSettings& settings,
                 RayCounts& rays)
        : t_(t), seeds_(seeds), settings_(settings), counts_(rays) {}

    BuiltField run() {
        std::vector<Landing> seen;
        for (std::uint32_t round = 0; round < seed_rounds; ++round) {
            const std::vector<Landing> more = seed_landings(round);
            seen.insert(seen.end(), more.begin(), more.end());
        }
        FieldCells cells(scale_of(t_, seen, settings_));
        sort_by_place(seen, cells.scale().size);
        cells_ = &cells;
        std::vector<ElementId> homes(seen.size(), no_element);
        for (int octave = 0; octave <= settings_.finest && !stopped(); ++octave) {
            add(seen, homes);
            survey();
            add_edges();
        }
        // All fine cells stand before links are made to them.
        close();
        for (int octave = 0; octave <= settings_.finest && !edges_.empty() && !stopped(); ++octave) {
            add_edges();
            close();
        }
        while (links_.first.size() <= cells.elements().size()) links_.end_element();  // a stopped build
        common_find_ = common_find();
        limit_strongest();
        FieldFigures figures;
        Reflections reflections = reflect();
        BrightSurfaces bright = find_bright(cells, links_, irradiance_, middle_distance());
        if (!bright.cones.empty() && settings_.guided_rays > 0 && !stopped()) {
            guide(bright.cones);
            reflections = reflect();
        }
        add_links_to_vectors();
        noisy_.smoothness.resize(cells.elements().size());
        std::vector<ElementArrivals> arrivals;
        if (settings_.arrivals) {
            straight_.resize(cells.elements().size());
            arrivals = make_arrivals(cells, links_, irradiance_, share(), straight_, settings_.threads);
        }
        figures.iterations = reflections.computed();
        figures.elements = cells.elements().size();
        figures.links = links_.links.size();
        figures.unresolved = static_cast<double>(unresolved_)
                             / std::max<double>(1, static_cast<double>(links_.links.size() + unresolved_));
        const float most_found = std::max(common_find_, most_found_by_chance * bright.mean_radiance);
        return {std::move(cells),
                std::move(bright),
                std::move(arrivals),
                std::move(noisy_),
                most_found,
                std::move(reflections),
                figures};
    }

  private:
    [[nodiscard]] bool stopped() const { return settings_.stop && settings_.stop(); }
    /// To what rays from the seeds see, metres.
    [[nodiscard]] double middle_distance() const {
        return double{cells_->scale().size} / double{settings_.cell};
    }
    [[nodiscard]] float share() const { return 1 / static_cast<float>(settings_.rays); }

    /// Calls `work(i, counts)` for all i < count in parallel.
    template <typename Work>
    void in_parallel(std::size_t count, const Work& work) {
        std::mutex mutex;
        parallel_for(settings_.threads, count, [&](std::size_t i) {
            RayCounts counts;
            work(i, counts);
            const std::lock_guard lock(mutex);
            counts_.add(counts);
        });
    }

    /// Where rays from the seeds land, in order of seeds.
    std::vector<Landing> seed_landings(std::uint32_t round) {
        std::vector<std::vector<Landing>> found(seeds_.size());
        FieldSettings few = settings_;
        few.rays = seed_rays;
        few.light_samples = 0;
        few.bounces = unlimited_depth;
        few.seed = hash(settings_.seed, 0x73656564, round);
        in_parallel(seeds_.size(), [&](std::size_t i, RayCounts& counts) {
            if (stopped()) return;
            const StartPoint from{seeds_[i].position, seeds_[i].normal, seeds_[i].offset};
            found[i] =
                trace_element(t_, from.normal, {&from, 1}, static_cast<ElementId>(i), few.rays, few, counts)
                    .landings;
        });
        std::vector<Landing> all;
        for (const auto& landings : found) all.insert(all.end(), landings.begin(), landings.end());
        return all;
    }

    [[nodiscard]] bool full() const { return cells_->elements().size() >= settings_.most_elements; }

    /// Where the camera's gather rays land, cells are fine. `homes`: by landing, the element that stands for
    /// it; only what divided ones stand for needs others.
    void add(const std::vector<Landing>& landings, std::vector<ElementId>& homes) {
        for (std::size_t i = 0; i < landings.size(); ++i) {
            const Landing& l = landings[i];
            if (homes[i] != no_element && !cells_->elements()[homes[i]].divided) continue;
            homes[i] = full() ? cells_->find(l.position, l.normal)
                              : cells_->find_or_make_fine(l.position, l.normal, l.offset);
            if (homes[i] != no_element && homes[i] >= surveyed_)
                met_.offer(homes[i], {l.position, l.normal, l.offset});
        }
    }

    /// Gives all of what an element with an edge of light stands for cells of the next size.
    void add_edges() {
        for (const StartPoint& p : edges_)
            if (!full()) (void)cells_->find_or_make_fine(p.position, p.normal, p.offset);
        edges_.clear();
    }

    /// Samples the lights from the elements that are new, and finds those that are to be divided.
    void survey() {
        struct Surveyed {
            std::vector<StartPoint> points;
            ElementSurvey survey;
        };
        while (surveyed_ < cells_->elements().size() && !stopped()) {
            std::vector<Surveyed> all(std::min(generation, cells_->elements().size() - surveyed_));
            const double mean_light = surveyed_ > 0 ? light_ / static_cast<double>(surveyed_) : 0;
            in_parallel(all.size(), [&](std::size_t i, RayCounts& counts) {
                const auto id = static_cast<ElementId>(surveyed_ + i);
                FieldElement& element = cells_->elements()[id];
                center(t_, *cells_, element, counts);
                all[i].points = start_points(t_, *cells_, id, met_.of(id), settings_.seed, counts);
                all[i].survey = survey_element(t_, element.normal, all[i].points, id, settings_, counts);
                if (t_.caustics)
                    t_.caustics->add_arriving(element, all[i].points, settings_.bounces, all[i].survey.light);
            });
            for (Surveyed& s : all) {
                if (divide(s.survey, mean_light))
                    edges_.insert(edges_.end(), s.points.begin(), s.points.end());
                met_.set(static_cast<ElementId>(surveyed_++), std::move(s.points));
            }
        }
    }

    /// Whether the edge of a light's shadow crosses the next element, and smaller cells may show where.
    /// `mean_light`: of elements so far, from samples of the lights, W·m⁻².
    bool divide(const ElementSurvey& survey, double mean_light) {
        FieldElement& element = cells_->elements()[surveyed_];
        element.irradiance = survey.light;
        const float light = luminance(survey.light.towards(element.normal));
        light_ += light;
        const int coarse = cells_->scale().coarsest_level(element.position);
        const bool divisible = !element.coarse && element.level < coarse + cells_->scale().finest;
        const bool edge = survey.contrast > settings_.edge_above * std::max(mean_light, double{light});
        element.divided = divisible && (edge || element.size > settings_.divide_above * survey.distance);
        const float room = settings_.divide_above * survey.distance / element.size;  // 1: just not divided
        noisy_.smoothness.push_back(std::clamp(room - 1, 0.0f, 1.0f));
        return edge && (divisible || element.coarse);
    }

    /// What an element's rays have found, and where of that there are elements already.
    struct Traced {
        ElementView view;
        std::vector<ElementId> to;  // by landing
    };

    /// Traces elements in the order in which they were made, until no new ones are met.
    void close() {
        for (survey(); traced_ < surveyed_ && !stopped(); survey()) {
            std::vector<Traced> all(std::min(generation, surveyed_ - traced_));
            in_parallel(all.size(), [&](std::size_t i, RayCounts& counts) {
                const auto id = static_cast<ElementId>(traced_ + i);
                all[i].view = trace_element(t_, cells_->elements()[id].normal, met_.of(id), id, rays_of(id),
                                            settings_, counts);
                for (const Landing& l : all[i].view.landings)
                    all[i].to.push_back(cells_->find(l.position, l.normal));
            });
            for (Traced& traced : all) link(traced);
        }
    }

    /// How many rays an element is worth.
    [[nodiscard]] int rays_of(ElementId id) const {
        const auto part = [&](int of) {
            const auto packet = static_cast<int>(packet_size);
            return (settings_.rays / of + packet - 1) / packet * packet;
        };
        const FieldElement& e = cells_->elements()[id];
        return part(e.divided ? divided_part : noisy_.smoothness[id] >= smooth_from ? smooth_part : 1);
    }

    /// What links of an element count for that has fewer rays than others.
    [[nodiscard]] float worth(std::size_t id) const {
        return static_cast<float>(settings_.rays) / static_cast<float>(rays_of(static_cast<ElementId>(id)));
    }

    /// Links an element to where its rays have landed: to elements `to`, and such that are made where there
    /// are none.
    void add_links(FieldLinks& links, std::size_t from, const std::vector<Landing>& landings,
                   std::span<const ElementId> to, bool may_make) {
        const Frame frame = frame_around(cells_->elements()[from].normal);
        const float times = worth(from);
        for (std::size_t i = 0; i < landings.size(); ++i) {
            const Landing& l = landings[i];
            const ElementId id = to[i] == no_element && may_make && !full()
                                     ? cells_->find_or_make_coarse(l.position, l.normal, l.offset)
                                     : to[i];
            if (id == no_element) {
                ++unresolved_;
                continue;
            }
            if (id >= surveyed_) met_.offer(id, {l.position, l.normal, l.offset});
            links.links.push_back(make_link(id, l.ray, pack_direction(frame.to_local({l.direction})),
                                            l.throughput * times, l.lobes));
        }
    }

    /// Turns what the next element has seen into links.
    void link(const Traced& traced) {
        add_links(links_, traced_, traced.view.landings, traced.to, true);
        links_.end_element();
        FieldElement& element = cells_->elements()[traced_];
        IrradianceVector light = traced.view.light;
        light.add(traced.view.reflected, 1);
        element.irradiance.add(light, 1);
        noisy_.light.push_back(light);
        reflected_.push_back(traced.view.reflected.towards(element.normal));
        strongest_.push_back(traced.view.strongest);
        finds_.insert(finds_.end(), traced.view.finds.begin(), traced.view.finds.end());
        if (settings_.arrivals)
            straight_.add(element.normal, luminance(element.irradiance.towards(element.normal)),
                          traced.view.sky);
        ++traced_;
    }

    /// What one find along lobes in a hundred exceeds. Where bright finds are common, as of a bulb in a ball
    /// of glass, that is as much as any.
    [[nodiscard]] float common_find() {
        if (finds_.empty()) return infinity;
        const auto rank = static_cast<std::ptrdiff_t>((finds_.size() - 1) * 99 / 100);
        std::ranges::nth_element(finds_, finds_.begin() + rank);
        return finds_[static_cast<std::size_t>(rank)];
    }

    /// Light that hardly any ray finds, and then a lot of it, would be seen as dots: a ray of an element
    /// brings no more than eight times what elements receive on average.
    void limit_strongest() {
        double mean_light = 0;
        for (std::size_t i = 0; i < traced_; ++i) {
            const FieldElement& e = cells_->elements()[i];
            mean_light += luminance(e.irradiance.towards(e.normal)) / static_cast<double>(traced_);
        }
        const float common = common_find_ * pi / static_cast<float>(settings_.rays);
        const auto limit = std::max(static_cast<float>(most_by_chance * mean_light), common);
        for (std::size_t i = 0; i < traced_; ++i) {
            FieldElement& e = cells_->elements()[i];
            const Spectrum strongest = strongest_[i].towards(e.normal);
            const float found = luminance(strongest), most = limit * worth(i);
            if (found <= most) continue;
            reflected_[i] += strongest * (most / found - 1);
            e.irradiance.add(strongest_[i], most / found - 1);
            noisy_.light[i].add(strongest_[i], most / found - 1);
        }
        strongest_.clear();
    }

    Reflections reflect() {
        return iterate(links_, light_along_normals(), share(), settings_.bounces, settings_.threads,
                       irradiance_);
    }

    /// Gives all elements rays towards the bright ones.
    void guide(const BrightCones& cones) {
        FieldLinks guided;
        const std::size_t all = cells_->elements().size();
        for (std::size_t first = 0; first < all; first += generation) {
            const std::size_t count = std::min(generation, all - first);
            struct Guided {
                GuidedView view;
                std::vector<ElementId> to;
            };
            std::vector<Guided> all_guided(count);
            in_parallel(count, [&](std::size_t i, RayCounts& counts) {
                const auto id = static_cast<ElementId>(first + i);
                all_guided[i].view = guide_element(t_, cells_->elements()[id].normal, met_.of(id), cones, id,
                                                   rays_of(id), settings_, counts);
                for (const Landing& l : all_guided[i].view.landings)
                    all_guided[i].to.push_back(cells_->find(l.position, l.normal));
            });
            for (std::size_t i = 0; i < count; ++i) {
                const Guided& g = all_guided[i];
                for (const Link& l : links_.of(first + i))
                    guided.links.push_back(
                        make_link(l.to, l.ray, l.direction, l.value() * g.view.share[l.ray], l.lobes));
                add_links(guided, first + i, g.view.landings, g.to, false);
                guided.end_element();
            }
        }
        links_ = std::move(guided);
    }

    [[nodiscard]] ElementLight light_along_normals() const {
        ElementLight light{{}, reflected_};
        for (const FieldElement& e : cells_->elements())
            light.straight.push_back(e.irradiance.towards(e.normal));
        for (std::size_t i = 0; i < reflected_.size(); ++i)
            light.straight[i] = light.straight[i] - reflected_[i];
        return light;
    }

    /// Gives every element's vector the light that arrives along its links.
    void add_links_to_vectors() {
        noisy_.light.resize(cells_->elements().size());
        in_parallel(cells_->elements().size(), [&](std::size_t i, RayCounts&) {
            FieldElement& e = cells_->elements()[i];
            const Frame frame = frame_around(e.normal);
            Spectrum along_s, along_t;  // add_arriving in that frame
            for (const Link& l : links_.of(i)) {
                const Spectrum arriving = l.value() * irradiance_[l.to];
                const Vec3 from = unpack_direction(l.direction).v;
                const Spectrum tilted = arriving * (1 / std::max(from.z, least_tilt_cosine));
                along_s += tilted * from.x;
                along_t += tilted * from.y;
            }
            // The iterations' sum along the normal, the links' shape around it.
            IrradianceVector vector;
            vector.add(e.normal, irradiance_[i] - e.irradiance.towards(e.normal));
            vector.add(frame.s, along_s * share());
            vector.add(frame.t, along_t * share());
            e.irradiance.add(vector, 1);
            noisy_.light[i].add(vector, 1);
        });
    }

    const Transport& t_;
    std::span<const FieldSeed> seeds_;
    const FieldSettings& settings_;
    RayCounts& counts_;
    FieldCells* cells_ = nullptr;
    FieldLinks links_;
    std::vector<Spectrum> irradiance_;
    std::size_t surveyed_ = 0, traced_ = 0, unresolved_ = 0;
    std::vector<IrradianceVector> strongest_;  // by traced element
    std::vector<Spectrum> reflected_;          // likewise, of lights along lobes, as of its irradiance
    StraightLight straight_;                   // likewise, if arrivals are wanted
    std::vector<float> finds_;                 // of all rays, along lobes
    float common_find_ = infinity;
    NoisyLight noisy_;
    double light_ = 0;     // of surveyed elements: sum of irradiance that samples of the lights find
    PointReservoirs met_;  // where rays have met elements; of surveyed ones, where rays start
    std::vector<StartPoint> edges_;  // of elements since the last octave that edges of shadows cross
};

}  // namespace

BuiltField build_field(const Transport& t, std::span<const FieldSeed> seeds, const FieldSettings& settings,
                       RayCounts& rays) {
    return FieldBuilder(t, seeds, settings, rays).run();
}

}  // namespace relumine
