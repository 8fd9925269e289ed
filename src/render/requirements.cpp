#include "render/requirements.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>

#include "device/tables/least_green.h"
#include "frame/bindings.h"
#include "frame/camera_keys.h"
#include "render/denoising.h"
#include "render/track_list.h"

namespace kadr {
namespace {

constexpr FeatureInfo kFeatures[] = {
    {Feature::integrator_path, "integrator", "path", "settings"},
    {Feature::integrator_direct, "integrator", "direct", "settings"},
    {Feature::camera_lens, "camera", "depth of field", "settings"},
    {Feature::camera_orthographic, "camera", "orthographic", "cameras"},
    {Feature::shutter_curve, "shutter", "curve", "settings"},
    {Feature::shutter_rolling, "shutter", "rolling", "settings"},
    {Feature::blur_camera, "motion blur", "camera", "tracks and nodes"},
    {Feature::blur_instances, "motion blur", "instances", "nodes"},
    {Feature::blur_vertices, "motion blur", "vertices", "nodes"},
    {Feature::blur_lights, "motion blur", "lights", "lights"},
    {Feature::moves_instances, "motion", "instances that move over the shot", "nodes"},
    {Feature::switches_instances, "motion", "instances that are shown and hidden", "nodes"},
    {Feature::copies, "geometry", "copies", "scenes and nodes"},
    {Feature::skins, "geometry", "skins", "nodes"},
    {Feature::morph_targets, "geometry", "morph targets", "nodes"},
    {Feature::vertex_colors, "geometry", "vertex colours", "meshes"},
    {Feature::second_uv_set, "geometry", "second texture coordinates", "meshes"},
    {Feature::dielectric, "materials", "dielectric", "materials"},
    {Feature::index_of_refraction, "materials", "index of refraction", "materials"},
    {Feature::exact_fresnel, "materials", "Fresnel's equations", "settings"},
    {Feature::metallic, "materials", "metallic", "materials"},
    {Feature::mirror, "materials", "smoother than roughness 0.032", "materials"},
    {Feature::unlit, "materials", "unlit", "materials"},
    {Feature::alpha_mask, "materials", "alpha mask", "materials"},
    {Feature::alpha_blend, "materials", "alpha blend", "materials"},
    {Feature::back_face_culling, "materials", "back-face culling", "settings"},
    {Feature::texture_base_color, "textures", "base colour", "materials"},
    {Feature::texture_metallic_roughness, "textures", "metallic-roughness", "materials"},
    {Feature::texture_normal, "textures", "normal", "materials"},
    {Feature::texture_emissive, "textures", "emissive", "materials"},
    {Feature::light_directional, "lights", "directional", "lights"},
    {Feature::light_sun, "lights", "sun with an angle", "lights"},
    {Feature::light_point, "lights", "point", "lights"},
    {Feature::light_sphere, "lights", "sphere", "lights"},
    {Feature::light_spot, "lights", "spot", "lights"},
    {Feature::light_area, "lights", "area", "lights"},
    {Feature::light_mesh, "lights", "emissive meshes", "materials"},
    {Feature::environment_color, "environment", "colour", "settings"},
    {Feature::environment_image, "environment", "image", "settings"},
    {Feature::transparent_background, "environment", "transparent background", "settings"},
    {Feature::layer_albedo, "layers", "albedo", "settings"},
    {Feature::layer_normal, "layers", "normal", "settings"},
    {Feature::layer_depth, "layers", "depth", "settings"},
    {Feature::layer_motion, "layers", "motion", "settings"},
    {Feature::layer_samples, "layers", "samples", "settings"},
    {Feature::layer_error, "layers", "error", "settings"},
    {Feature::denoiser, "film", "denoiser", "settings"},
};

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Who asks for what, each once.
class Askers {
public:
    void add(Feature feature, const std::string& who) {
        Entry& entry = entries_[feature];
        if (entry.all.insert(who).second && entry.all.size() == 1) entry.first = who;
    }
    RequirementSet set() const {
        RequirementSet set;
        for (const auto& [feature, entry] : entries_) set.entries.push_back({feature, entry.first, entry.all.size()});
        return set;
    }

private:
    struct Entry {
        std::string first;
        std::set<std::string> all;
    };
    std::map<Feature, Entry> entries_;
};

/// While the shutter is open: its ends and its middle.
struct Opening {
    double open_s, middle_s, close_s;
};

std::vector<Opening> openings_of(const BoundShot& shot) {
    const std::vector<int>& frames = shot.timing().frames;
    const std::size_t count = std::min(frames.size(), kMostFramesLookedAt);
    std::vector<Opening> openings;
    for (std::size_t i = 0; i < count; ++i) {
        const FrameTime time = shot.sequence().frame(frames[count > 1 ? i * (frames.size() - 1) / (count - 1) : 0]);
        openings.push_back({time.open_s, 0.5 * (time.open_s + time.close_s), time.close_s});
    }
    return openings;
}

/// The walk through a shot.
class Requirements {
public:
    explicit Requirements(const BoundShot& shot)
        : shot_(shot), bindings_(shot.bindings()), openings_(openings_of(shot)), all_looked_at_(openings_.size() == shot.timing().frames.size()) {}

    RequirementSet find() {
        add_settings();
        add_camera();
        for (const InstanceSeed& seed : bindings_.seeds)
            if (is_seen(seed)) add_seed(seed);
        add_copies();
        for (const LightSpec& light : shot_.shot().lights)
            if (any_time([&](double time) { return is_on(light.visible, time); })) add_light(light);
        for (const LightSeed& light : bindings_.lights)
            if (any_time([&](double time) { return bindings_.visibility.at(time).visible(light.node, light.clip_offset_s()); })) add_light(light);
        add_environment();
        add_layers();
        return askers_.set();
    }

private:
    template <class Test>
    bool any_time(Test test) const {
        return std::any_of(openings_.begin(), openings_.end(), [&](const Opening& o) { return test(o.open_s) || test(o.middle_s) || test(o.close_s); });
    }

    /// Whether a value that may change does so while the shutter is open.
    template <class Value>
    bool blurs(Value value) const {
        const bool seen = std::any_of(openings_.begin(), openings_.end(), [&](const Opening& o) {
            if (!(o.close_s > o.open_s)) return false;
            const auto first = value(o.open_s);
            return value(o.middle_s) != first || value(o.close_s) != first;
        });
        return seen || (!all_looked_at_ && opens());
    }
    bool opens() const {
        return std::any_of(openings_.begin(), openings_.end(), [](const Opening& o) { return o.close_s > o.open_s; });
    }
    /// Whether it changes at all between the first opening and the last closing.
    template <class Value>
    bool changes(Value value) const {
        const auto first = value(openings_.front().open_s);
        return !all_looked_at_ || any_time([&](double time) { return value(time) != first; });
    }

    std::string node_name(int node) const { return fmt::format("node '{}'", node_path(shot_.scene(), bindings_.rig.file_of(node), node)); }

    void add_settings() {
        const Shot& shot = shot_.shot();
        askers_.add(shot.render.integrator == Integrator::path ? Feature::integrator_path : Feature::integrator_direct, "render.integrator");
        if (shot.render.cull_backfaces) askers_.add(Feature::back_face_culling, "render.cull_backfaces");
        if (shot.shutter.curve.shape != ShutterCurve::Shape::box) askers_.add(Feature::shutter_curve, "shutter.curve");
        if (shot.shutter.rolling.direction != RollingShutter::Direction::none) askers_.add(Feature::shutter_rolling, "shutter.rolling");
    }

    /// What the camera turns about, looks at or focuses on.
    std::vector<NodeReference> camera_references() const {
        const CameraSpec& camera = shot_.shot().camera;
        std::vector<NodeReference> all;
        if (camera.around) all.push_back(*camera.around);
        if (const auto* target = std::get_if<NodeReference>(&camera.look_at); target && !camera.gltf) all.push_back(*target);
        if (camera.focus)
            if (const auto* focus = std::get_if<NodeReference>(&*camera.focus)) all.push_back(*focus);
        return all;
    }
    /// The same as nodes, and the one that it stands on.
    std::vector<int> camera_nodes() const {
        std::vector<int> nodes{bindings_.camera_node};
        for (const NodeReference& reference : camera_references()) nodes.push_back(shot_.node_of(reference));
        std::erase(nodes, -1);
        return nodes;
    }

    void add_camera() {
        const CameraSpec& camera = shot_.shot().camera;
        if (camera.f_stop) askers_.add(Feature::camera_lens, "camera.f_stop");
        if (bindings_.camera_node >= 0 && shot_.scene().cameras[index(shot_.scene().nodes[index(bindings_.camera_node)].camera)].orthographic)
            askers_.add(Feature::camera_orthographic, node_name(bindings_.camera_node));
        const std::vector<std::string> movers = camera_movers();
        if (movers.empty() || !blurs([&](double time) { return camera_at(shot_, time); })) return;
        for (const std::string& mover : movers) askers_.add(Feature::blur_camera, mover);
    }

    /// What may move the camera or change its lens.
    std::vector<std::string> camera_movers() const {
        std::vector<std::string> movers;
        for (const TrackInfo& track : tracks_of(shot_.shot()))
            if (track.name.starts_with("camera.")) movers.push_back(track.name);
        for (const int node : camera_nodes())
            if (bindings_.rig.moves(node)) movers.push_back(node_name(node));
        const int camera = bindings_.camera_node;
        if (camera >= 0 && !bindings_.properties.of(bindings_.rig.file_of(camera), PropertyOwner::camera, shot_.scene().nodes[index(camera)].camera).empty())
            movers.push_back(fmt::format("clips of scene '{}'", shot_.scene().files[index(bindings_.rig.file_of(camera))].id));
        for (const NodeReference& reference : camera_references())
            if (shot_.node_of(reference) < 0 && may_move(reference)) movers.push_back(fmt::format("scene '{}'", reference.text));
        return movers;
    }

    /// Whether any copy of a seed is shown in any frame.
    bool is_seen(const InstanceSeed& seed) const {
        if (!bindings_.visibility.ever_hides(seed.mesh_node)) return true;
        return !all_looked_at_ || any_time([&](double time) {
            const VisibilityRig::States states = bindings_.visibility.at(time);
            const auto& offsets = offsets_of(seed);
            return std::any_of(offsets.begin(), offsets.end(), [&](double offset) { return states.visible(seed.mesh_node, offset); });
        });
    }
    const std::vector<double>& offsets_of(const InstanceSeed& seed) const { return bindings_.entry_offsets_s[index(bindings_.rig.file_of(seed.mesh_node))]; }
    /// Copies that play their clips at other times move at other times: nothing is seen to stand still then.
    bool offset(const InstanceSeed& seed) const { return offsets_of(seed).size() > 1; }

    void add_seed(const InstanceSeed& seed) {
        const std::string node = node_name(seed.mesh_node);
        add_motion(seed, node);
        add_geometry(seed);
        if (seed.deformer >= 0) add_bending(seed, node);
        const auto& offsets = offsets_of(seed);
        std::set<std::uint32_t> materials;
        for (const double offset_s : offsets) materials.insert(bindings_.materials.material_in_copy(seed.material, offset_s));
        for (const std::uint32_t material : materials)
            if (done_.insert(material).second) add_material(material);
    }

    void add_motion(const InstanceSeed& seed, const std::string& node) {
        if (bindings_.visibility.ever_hides(seed.mesh_node)) askers_.add(Feature::switches_instances, node);
        if (!bindings_.rig.moves(seed.node)) return;
        const auto place = [&](double time) { return bindings_.node_transform(seed.node, time); };
        if (offset(seed) || changes(place)) askers_.add(Feature::moves_instances, node);
        if ((offset(seed) && opens()) || blurs(place)) askers_.add(Feature::blur_instances, node);
    }

    void add_geometry(const InstanceSeed& seed) {
        const GeometryData& geometry = shot_.scene().geometries[seed.geometry];
        const std::string name = fmt::format("mesh '{}'", geometry.name);
        if (!geometry.colors.empty()) askers_.add(Feature::vertex_colors, name);
        if (!geometry.uv[1].empty()) askers_.add(Feature::second_uv_set, name);
    }

    void add_bending(const InstanceSeed& seed, const std::string& node) {
        const Deformer& deformer = bindings_.deformers[index(seed.deformer)];
        if (deformer.skeleton) askers_.add(Feature::skins, node);
        if (!shot_.scene().geometries[seed.geometry].targets.empty()) askers_.add(Feature::morph_targets, node);
        if (!may_bend(deformer)) return;
        const auto pose = [&](double time) { return deformer.pose(shot_.scene(), bindings_, time); };
        if ((offset(seed) && opens()) || blurs(pose)) askers_.add(Feature::blur_vertices, node);
    }

    /// Whether anything ever moves its vertices.
    bool may_bend(const Deformer& deformer) const {
        const auto moves = [&](int node) { return bindings_.rig.moves(node); };
        if (deformer.skeleton && std::any_of(deformer.skeleton->nodes().begin(), deformer.skeleton->nodes().end(), moves)) return true;
        return bindings_.morphs.moves(deformer.mesh_node);
    }

    void add_material(std::uint32_t material) {
        const int source = bindings_.materials.source_of(material);
        const std::string name = fmt::format("material '{}'", shot_.scene().material_names[index(source)]);
        if (bindings_.materials.may_light(material)) askers_.add(Feature::light_mesh, name);
        for (const Opening& opening : openings_) {
            const std::vector<kernels::Material> table = bindings_.materials.table(opening.middle_s);
            add_looks(table.empty() ? shot_.scene().materials[material] : table[material], bindings_.materials.may_light(material), name);
            if (material == static_cast<std::uint32_t>(source)) return;  // the file's own: it never changes
        }
    }

    void add_looks(const kernels::Material& m, bool emits, const std::string& name) {
        if (m.alpha_mode == kernels::AlphaMode::mask) askers_.add(Feature::alpha_mask, name);
        if (m.alpha_mode == kernels::AlphaMode::blend) askers_.add(Feature::alpha_blend, name);
        if (m.base_color_texture.texture >= 0) askers_.add(Feature::texture_base_color, name);
        if (m.unlit) return askers_.add(Feature::unlit, name);
        const bool textured = m.metallic_roughness_texture.texture >= 0;
        const bool dielectric = m.metallic < 1 || textured;
        if (dielectric) askers_.add(Feature::dielectric, name);
        if (dielectric && shot_.shot().render.fresnel == FresnelKind::exact) askers_.add(Feature::exact_fresnel, "render.fresnel");
        if (m.dielectric_f0 != kernels::kDielectricF0) askers_.add(Feature::index_of_refraction, name);
        if (m.metallic > 0) askers_.add(Feature::metallic, name);
        if (shot_.shot().render.integrator == Integrator::path && is_mirror(m, [&](int texture) { return least_green(shot_.scene().textures[index(texture)]); })) askers_.add(Feature::mirror, name);
        if (textured) askers_.add(Feature::texture_metallic_roughness, name);
        if (m.normal_texture.texture >= 0) askers_.add(Feature::texture_normal, name);
        if (emits && m.emissive_texture.texture >= 0) askers_.add(Feature::texture_emissive, name);
    }

    void add_copies() {
        for (std::size_t file = 0; file < shot_.scene().files.size(); ++file)
            if (!bindings_.instances.copies_of(static_cast<int>(file)).empty())
                askers_.add(Feature::copies, fmt::format("scene '{}'", shot_.scene().files[file].id));
        for (const InstanceSeed& seed : bindings_.seeds)
            if (shot_.scene().nodes[index(seed.mesh_node)].placement_set >= 0) askers_.add(Feature::copies, node_name(seed.mesh_node));
    }

    static Feature kind_of(const LightSpec& light) {
        const bool sun = largest_of(light.angular_diameter_rad) > 0, sphere = largest_of(light.radius_m) > 0;
        switch (light.kind) {
            case LightKind::directional: return sun ? Feature::light_sun : Feature::light_directional;
            case LightKind::point: return sphere ? Feature::light_sphere : Feature::light_point;
            case LightKind::spot: return Feature::light_spot;
            case LightKind::area: break;
        }
        return Feature::light_area;
    }
    static double largest_of(const Track<double>& track) {
        double largest = 0;
        for (const Key<double>& key : track.keys) largest = std::max(largest, key.value);
        return largest;
    }

    void add_light(const LightSpec& light) {
        const std::string name = fmt::format("light '{}'", light.id);
        askers_.add(kind_of(light), name);
        const std::string prefix = fmt::format("lights.{}.", light.id);
        for (const TrackInfo& track : tracks_of(shot_.shot()))
            if (track.name.starts_with(prefix) && track_blurs(track)) askers_.add(Feature::blur_lights, name);
        if (!light.look_at) return;
        if (const auto* target = std::get_if<NodeReference>(&*light.look_at))
            if (may_move(*target) && blurs([&](double time) { return bindings_.position_of(*target, time); })) askers_.add(Feature::blur_lights, name);
    }
    bool may_move(const NodeReference& reference) const {
        const int node = shot_.node_of(reference);
        return node >= 0 ? bindings_.rig.moves(node) : varies(shot_.shot().scenes[index(shot_.scene_of(reference))].transform);
    }
    bool track_blurs(const TrackInfo& track) const {
        const bool seen = std::any_of(openings_.begin(), openings_.end(), [&](const Opening& o) {
            return o.close_s > o.open_s && (track.changes(o.open_s, o.middle_s) || track.changes(o.open_s, o.close_s));
        });
        return seen || (!all_looked_at_ && opens());
    }

    void add_light(const LightSeed& seed) {
        const int light = shot_.scene().nodes[index(seed.node)].light;
        const kernels::LightKind kind = shot_.scene().lights[index(light)].kind;
        const std::string name = node_name(seed.node);
        askers_.add(kind == kernels::LightKind::directional ? Feature::light_directional : kind == kernels::LightKind::spot ? Feature::light_spot : Feature::light_point, name);
        const bool driven = !bindings_.properties.of(bindings_.rig.file_of(seed.node), PropertyOwner::light, light).empty();
        const bool moves = bindings_.rig.moves(seed.node) && blurs([&](double time) { return bindings_.node_transform(seed.node, seed.copy, time); });
        if (opens() && (driven || moves)) askers_.add(Feature::blur_lights, name);
    }

    void add_environment() {
        const EnvironmentSpec& environment = shot_.shot().environment;
        if (!environment.visible) askers_.add(Feature::transparent_background, "environment.visible");
        if (environment.given && environment.image) return askers_.add(Feature::environment_image, "environment.image");
        if (environment.given) return shines(environment) ? askers_.add(Feature::environment_color, "environment.color") : void();
        if (shot_.shot().lights.empty() && bindings_.lights.empty()) askers_.add(Feature::environment_color, "the sky of a shot without lights");
    }
    bool shines(const EnvironmentSpec& environment) const {
        return any_time([&](double time) { return evaluate(environment.color, time) * evaluate(environment.strength, time) != glm::dvec3(0); });
    }

    void add_layers() {
        constexpr std::pair<Aov, Feature> kLayers[] = {{Aov::albedo, Feature::layer_albedo},   {Aov::normal, Feature::layer_normal},
                                                       {Aov::depth, Feature::layer_depth},     {Aov::motion, Feature::layer_motion},
                                                       {Aov::samples, Feature::layer_samples}, {Aov::error, Feature::layer_error}};
        for (const auto& [aov, feature] : kLayers)
            if (shot_.shot().output.has(aov)) askers_.add(feature, "output.aovs");
        if (shot_.shot().render.denoise == DenoiserKind::none) return;
        askers_.add(Feature::denoiser, "render.denoise");
        askers_.add(Feature::layer_albedo, "render.denoise");
        askers_.add(Feature::layer_normal, "render.denoise");
    }

    const BoundShot& shot_;
    const Bindings& bindings_;
    const std::vector<Opening> openings_;
    const bool all_looked_at_;
    std::set<std::uint32_t> done_;  ///< materials
    Askers askers_;
};

}  // namespace

std::span<const FeatureInfo> all_features() { return kFeatures; }

const FeatureInfo& info_of(Feature feature) { return kFeatures[static_cast<std::size_t>(feature)]; }

const Requirement* RequirementSet::find(Feature feature) const {
    const auto found = std::find_if(entries.begin(), entries.end(), [feature](const Requirement& entry) { return entry.feature == feature; });
    return found == entries.end() ? nullptr : &*found;
}

RequirementSet requirements_of(const BoundShot& shot) { return Requirements(shot).find(); }

}  // namespace kadr
