#include "render/reel_plan.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/problem.h"
#include "output/image_io.h"
#include "render/loaded_shot.h"
#include "render/output_plan.h"
#include "render/reel_conform.h"

namespace kadr {
namespace {

constexpr VideoKeys kReelKeys{"size", "fps"};

/// Runs one group of checks; its problems join those of the others instead of hiding them, each once.
template <class Check>
void collect_once(std::vector<Diagnostic>& problems, const Check& check) {
    try {
        check();
    } catch (const InputError& error) {
        for (const Diagnostic& problem : error.diagnostics()) {
            const auto same = [&](const Diagnostic& other) { return other.text() == problem.text(); };
            if (std::none_of(problems.begin(), problems.end(), same)) problems.push_back(problem);
        }
    }
}

/// The output folder knows places, not the lines that stand there.
template <class Check>
void collect_with_lines(std::vector<Diagnostic>& problems, const Check& check) {
    std::vector<Diagnostic> found;
    collect_once(found, check);
    for (const Diagnostic& problem : found) problems.push_back(problem_at(problem.where, problem.found, problem.expected));
}

void replace_all(std::string& text, std::string_view from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

/// Makes one plan, step by step.
class Planner {
public:
    explicit Planner(Reel reel) { plan_.reel = std::move(reel); }

    ReelPlan run(const ShotOverrides& overrides) {
        plan_.warnings = plan_.reel.warnings;
        plan_files();
        for (std::size_t i = 0; i < plan_.reel.entries.size(); ++i) bind(i);
        stop_at_problems();
        cut();
        place_sources();
        choose_frames(overrides.frames);
        stop_at_problems();
        time_sound();
        return std::move(plan_);
    }

private:
    void stop_at_problems() {
        if (!problems_.empty()) throw InputError(std::move(problems_));
    }

    void bind(std::size_t index) {
        const ReelEntry& entry = plan_.reel.entries[index];
        BoundEntry bound{&entry, {}, fmt::format("shots.{}", index)};
        collect_once(problems_, [&] {
            LoadOptions options;
            options.decode_textures = false;
            const LoadedShot loaded(entry.shot, options, Reading::everything);
            bound.frames = loaded.bound().timing().frames;
            add_warnings(loaded.warnings());
        });
        if (entry.shot.environment.image)
            collect_once(problems_, [&] { image_io().read_metadata(*entry.shot.environment.image); });
        bound_.push_back(std::move(bound));
    }

    void add_warnings(const std::vector<Diagnostic>& warnings) {
        for (const Diagnostic& warning : warnings) {
            const auto same = [&](const Diagnostic& other) { return other.text() == warning.text(); };
            if (std::none_of(plan_.warnings.begin(), plan_.warnings.end(), same)) plan_.warnings.push_back(warning);
        }
    }

    void cut() {
        std::vector<Cut> cuts;
        for (const BoundEntry& bound : bound_) cuts.push_back(cut_of(plan_.reel, bound, problems_));
        check_lengths(plan_.reel, cuts, problems_);
        check_total(cuts);
        stop_at_problems();
        plan_.edit = ReelEdit(std::move(cuts));
    }

    void check_total(const std::vector<Cut>& cuts) {
        constexpr std::int64_t kMostFrames = 10'000'000;
        std::int64_t total = 0;
        for (const Cut& each : cuts) total += each.length();
        if (total > kMostFrames)
            problems_.push_back(problem_at(plan_.reel.where, fmt::format("the reel has more than {} frames", kMostFrames),
                                           "shorten its shots or holds"));
    }

    void place_sources() {
        taken_.insert(plan_.reel.output.frames.begin(), plan_.reel.output.frames.end());
        std::map<std::string, int> known;
        for (const BoundEntry& bound : bound_) {
            ReelSource source = conform(plan_.reel, bound);
            const auto [at, fresh] = known.emplace(source.identity, static_cast<int>(plan_.sources.size()));
            if (fresh) plan_.sources.push_back(std::move(source));
            plan_.source_of.push_back(at->second);
        }
        // The shots' own files first: what moves away goes around them.
        for (ReelSource& source : plan_.sources) source.own = source.own && take(source.prepared.shot.output.frames);
        for (ReelSource& source : plan_.sources)
            if (!source.own) move_to_reel(source.prepared.shot);
    }

    bool take(const std::vector<std::string>& patterns) {
        const bool free = std::none_of(patterns.begin(), patterns.end(), [&](const auto& each) { return taken_.count(each) > 0; });
        if (free) taken_.insert(patterns.begin(), patterns.end());
        return free;
    }

    /// Frames that differ from the shot's own must not lie in their place: the two would take turns.
    void move_to_reel(Shot& shot) {
        std::string pattern;
        for (int number = 1; pattern.empty() || !take({pattern}); ++number) {
            pattern = plan_.reel.shot_frames;
            replace_all(pattern, "{shot}", number == 1 ? shot.name : fmt::format("{}-{}", shot.name, number));
        }
        shot.output.frames = {pattern};
        shot.output.frames_where = {SourceLocation{plan_.reel.file.string(), 0, 0}};
        if (!pattern.ends_with(".exr")) shot.output.aovs.clear();
    }

    void choose_frames(const std::string& list) {
        const int count = plan_.edit.frame_count();
        if (list.empty())
            for (int frame = 0; frame < count; ++frame) plan_.frames.push_back(frame);
        else
            plan_.frames = parse_frame_list(list);
        if (plan_.frames.front() < 0 || plan_.frames.back() >= count)
            throw InputError(fmt::format("--frames is {}", list),
                             fmt::format("expected frames of the reel, which has 0 to {}", count - 1));
        std::vector<std::set<int>> needed(plan_.sources.size());
        for (const int frame : plan_.frames)
            for (const ReelFrame::Layer& layer : plan_.edit.frame(frame).layers)
                needed[static_cast<std::size_t>(plan_.source_of[static_cast<std::size_t>(layer.cut)])].insert(layer.frame);
        for (std::size_t i = 0; i < needed.size(); ++i)
            plan_.sources[i].prepared.shot.timing.frames.assign(needed[i].begin(), needed[i].end());
        for (const ReelSource& source : plan_.sources)
            for (Diagnostic& problem : colliding_patterns(source.prepared.shot.output, source.prepared.shot.timing.frames))
                problems_.push_back(std::move(problem));
    }

    void plan_files() {
        const Reel& reel = plan_.reel;
        if (reel.output.video)
            collect_with_lines(problems_, [&] {
                plan_.video = plan_video(*reel.output.video, reel.image.width, reel.image.height, reel.fps, kReelKeys);
            });
        if (plan_.video && reel.sound)
            collect_with_lines(problems_, [&] { plan_.video->sound = plan_sound(*reel.sound, *plan_.video); });
    }

    /// The part of the sound that lies under the frames that are made.
    void time_sound() {
        if (!plan_.video || !plan_.video->sound) return;
        const int first = plan_.frames.front(), count = static_cast<int>(plan_.frames.size());
        const auto seconds = [&](int frames) { return make_rational(frames, 1) / plan_.reel.fps; };
        plan_.video->sound->whole_s = seconds(plan_.edit.frame_count());
        plan_.video->sound->from_s = seconds(first);
        plan_.video->sound->length_s = seconds(count);
        if (plan_.frames.back() - first + 1 == count) return;
        plan_.video->sound.reset();
        Diagnostic silent;
        silent.warning = true;
        silent.found = "--frames leaves gaps, so this video has no sound";
        plan_.warnings.push_back(std::move(silent));
    }

    ReelPlan plan_;
    std::vector<BoundEntry> bound_;
    std::vector<Diagnostic> problems_;
    std::set<std::string> taken_;
};

void check_folders(const ReelPlan& plan) {
    std::set<std::filesystem::path> folders;
    for (const auto& folder : output_folders(plan.reel.output, plan.frames)) folders.insert(folder);
    for (const ReelSource& source : plan.sources)
        for (const auto& folder : output_folders(source.prepared.shot.output, source.prepared.shot.timing.frames))
            folders.insert(folder);
    std::vector<Diagnostic> problems;
    for (const std::filesystem::path& folder : folders) {
        const std::string reason = why_not_writable(folder);
        if (!reason.empty())
            problems.push_back(problem_at({plan.reel.file.string(), 0, 0},
                                          fmt::format("cannot write to the folder {}", folder.string()), reason));
    }
    if (!problems.empty()) throw InputError(std::move(problems));
}

std::string joined_text(const Cut& cut) {
    std::string text;
    const auto add = [&](const char* name, int frames) {
        if (frames > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, frames);
    };
    add("fade in", cut.fade_in);
    add("hold", cut.hold);
    add("cross-fade", cut.crossfade);
    add("fade out", cut.fade_out);
    return text;
}

}  // namespace

ReelPlan plan_reel(const std::filesystem::path& reel, const ShotOverrides& overrides) {
    return Planner(parse_reel(reel, overrides)).run(overrides);
}

std::string edit_text(const ReelPlan& plan) {
    const double fps = plan.reel.fps.value();
    std::string text = fmt::format("reel {}: {} frames, {:.3f} s at {} fps, {}x{}\n", plan.reel.name, plan.edit.frame_count(),
                                   plan.edit.frame_count() / fps, format_number(fps), plan.reel.image.width, plan.reel.image.height);
    for (std::size_t i = 0; i < plan.edit.cuts().size(); ++i) {
        const Cut& cut = plan.edit.cuts()[i];
        const ReelSource& source = plan.sources[static_cast<std::size_t>(plan.source_of[i])];
        const std::string joined = joined_text(cut);
        text += fmt::format("  {:>6} {:8.3f} s  {:<16} frames {}-{}{}{}\n", plan.edit.begin(static_cast<int>(i)),
                            plan.edit.begin(static_cast<int>(i)) / fps, source.prepared.shot.name, cut.first,
                            cut.first + cut.count - 1, joined.empty() ? "" : "; " + joined,
                            source.own ? "" : fmt::format("; rendered for the reel at {} fps, {}x{}",
                                                          format_number(source.prepared.shot.timing.fps.value()),
                                                          source.prepared.shot.image.width, source.prepared.shot.image.height));
    }
    return text;
}

CheckReport check_reel(const std::filesystem::path& reel, const ShotOverrides& overrides, bool verbose) {
    const ReelPlan plan = plan_reel(reel, overrides);
    check_folders(plan);
    return {plan.warnings, verbose ? edit_text(plan) : std::string()};
}

}  // namespace kadr
