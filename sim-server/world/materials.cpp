#include "world/materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "base/text.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace fs = std::filesystem;

namespace {

Color grey(float level, float alpha = 1) { return {level, level, level, alpha}; }

MaterialDef plain(const Color& color, const Color& specular = grey(0.1F)) {
  MaterialDef material;
  material.ambient = material.diffuse = color;
  material.specular = specular;
  material.shininess = 1;
  return material;
}

MaterialDef glowing(const Color& color) {
  MaterialDef material = plain(color);
  material.emissive = color;
  return material;
}

}  // namespace

std::optional<MaterialDef> built_in_material(std::string_view name) {
  static const std::map<std::string_view, MaterialDef> table{
      {"Grey", plain(grey(0.7F))},
      {"Gray", plain(grey(0.7F))},
      {"DarkGrey", plain(grey(0.175F))},
      {"DarkGray", plain(grey(0.175F))},
      {"LightGrey", plain(grey(0.85F))},
      {"White", plain(grey(1))},
      {"FlatBlack", plain(grey(0.1F), grey(0.01F))},
      {"Black", plain(grey(0))},
      {"Red", plain({1, 0, 0, 1})},
      {"RedBright", plain({0.87F, 0.26F, 0.07F, 1})},
      {"Green", plain({0, 1, 0, 1})},
      {"Blue", plain({0, 0, 1, 1})},
      {"SkyBlue", plain({0.13F, 0.44F, 0.7F, 1})},
      {"Yellow", plain({1, 1, 0, 1})},
      {"ZincYellow", plain({0.972F, 0.953F, 0.208F, 1})},
      {"DarkYellow", plain({0.7F, 0.7F, 0, 1})},
      {"Gold", plain({0.8F, 0.648F, 0.12F, 1}, {0.8F, 0.8F, 0.5F, 1})},
      {"Purple", plain({1, 0, 1, 1})},
      {"Turquoise", plain({0, 1, 1, 1})},
      {"Orange", plain({1, 0.51F, 0.06F, 1})},
      {"Indigo", plain({0.33F, 0, 0.5F, 1})},
      {"White Glow", glowing(grey(1))},
      {"WhiteGlow", glowing(grey(1))},
      {"RedGlow", glowing({1, 0, 0, 1})},
      {"GreenGlow", glowing({0, 1, 0, 1})},
      {"BlueGlow", glowing({0, 0, 1, 1})},
      {"YellowGlow", glowing({1, 1, 0, 1})},
      {"PurpleGlow", glowing({1, 0, 1, 1})},
      {"TurquoiseGlow", glowing({0, 1, 1, 1})},
      {"RedTransparent", plain({1, 0, 0, 0.5F})},
      {"GreenTransparent", plain({0, 1, 0, 0.5F})},
      {"BlueTransparent", plain({0, 0, 1, 0.5F})},
      {"YellowTransparent", plain({1, 1, 0, 0.5F})},
      {"DarkOrangeTransparent", plain({0.6F, 0.3F, 0.02F, 0.4F})},
      {"OrangeTransparent", plain({1, 0.51F, 0.06F, 0.4F})},
      {"GreyTransparent", plain(grey(0.5F, 0.5F))},
      {"GrayTransparent", plain(grey(0.5F, 0.5F))},
      {"BlueLaser", plain({0, 0, 1, 0.4F})},
      {"LightBlueLaser", plain({0.5F, 0.5F, 1, 0.4F})},
      {"Residential", plain(grey(0.38F))},
      {"Road", plain(grey(0.3F))},
      {"Runway", plain(grey(0.33F))},
      {"Tarmac", plain(grey(0.3F))},
      {"PedestrianPath", plain(grey(0.6F))},
      {"Grass", plain({0.28F, 0.42F, 0.16F, 1})},
      {"GrassFloor", plain({0.28F, 0.42F, 0.16F, 1})},
      {"Wood", plain({0.55F, 0.38F, 0.22F, 1})},
      {"WoodFloor", plain({0.56F, 0.4F, 0.25F, 1})},
      {"WoodPallet", plain({0.6F, 0.46F, 0.3F, 1})},
      {"CeilingTiled", plain({0.85F, 0.84F, 0.8F, 1})},
      {"PaintedWall", plain({0.86F, 0.84F, 0.76F, 1})},
      {"Bricks", plain({0.55F, 0.3F, 0.24F, 1})},
      {"CloudySky", plain({0.6F, 0.7F, 0.85F, 1})},
      {"Pioneer2Body", plain({0.75F, 0.1F, 0.1F, 1})},
      {"PioneerBody", plain({0.75F, 0.1F, 0.1F, 1})},
      {"Eyebot", plain({0.9F, 0.9F, 0.2F, 1})},
      {"Editor", plain(grey(0.8F))},
      {"XYZPoints", plain({1, 1, 0, 1})},
      {"WideAngleCube", plain(grey(0.7F))},
      {"LightOn", glowing({0, 1, 0, 1})},
      {"LightOff", plain({1, 0, 0, 1})},
      {"DarkMagentaTransparent", plain({0.55F, 0, 0.55F, 0.4F})},
      {"PurpleTransparent", plain({1, 0, 1, 0.4F})},
      {"GrayGrid", plain(grey(0.5F))},
      {"GreyGrid", plain(grey(0.5F))},
      {"Chrome", plain(grey(0.75F), grey(0.9F))},
      {"BumpyMetal", plain(grey(0.55F), grey(0.5F))},
      {"RustySteel", plain({0.42F, 0.3F, 0.22F, 1})},
      {"RustyBarrel", plain({0.45F, 0.28F, 0.18F, 1})},
      {"LightWood", plain({0.7F, 0.55F, 0.36F, 1})},
      {"WoodTile", plain({0.58F, 0.42F, 0.27F, 1})},
      {"Brick", plain({0.55F, 0.3F, 0.24F, 1})},
      {"Rockwall", plain({0.45F, 0.43F, 0.4F, 1})},
      {"RockWall", plain({0.45F, 0.43F, 0.4F, 1})},
      {"Pedestrian", plain(grey(0.6F))},
      {"Footway", plain(grey(0.6F))},
      {"Steps", plain(grey(0.6F))},
      {"Primary", plain(grey(0.34F))},
      {"Secondary", plain(grey(0.36F))},
      {"Trunk", plain(grey(0.32F))},
      {"Motorway", plain(grey(0.3F))},
      {"Lanes_2", plain(grey(0.34F))},
      {"Lanes_6", plain(grey(0.34F))},
      {"EpuckBody", plain({0.2F, 0.55F, 0.25F, 1})},
      {"CoM", plain({0.9F, 0.9F, 0.3F, 1})},
      {"JointAnchor", plain({0.9F, 0.6F, 0.1F, 1})},
      {"Skull", plain(grey(0.85F))},
      {"ExclamationPoint", plain({0.95F, 0.8F, 0.1F, 1})},
      {"QuestionMark", plain({0.3F, 0.4F, 0.9F, 1})},
      {"SmileyHappy", plain({1, 0.85F, 0.15F, 1})},
      {"SmileyPlain", plain({1, 0.85F, 0.15F, 1})},
      {"SmileySad", plain({1, 0.85F, 0.15F, 1})},
      {"SmileyDead", plain({1, 0.85F, 0.15F, 1})},
  };
  if (!name.starts_with("Gazebo/")) return std::nullopt;
  const auto found = table.find(name.substr(7));
  if (found == table.end()) return std::nullopt;
  MaterialDef material = found->second;
  material.script = std::string(name);
  return material;
}

namespace {

// The words of a script, line by line; comments are gone and braces stand alone.
class ScriptLines {
 public:
  explicit ScriptLines(const std::string& text) {
    std::vector<std::string> line;
    std::string word;
    const auto end_word = [&] {
      if (!word.empty()) line.push_back(std::exchange(word, {}));
    };
    const auto end_line = [&] {
      end_word();
      if (!line.empty()) lines_.push_back(std::exchange(line, {}));
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char c = text[i];
      if (c == '/' && i + 1 < text.size() && text[i + 1] == '/') {
        while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
      } else if (c == '/' && i + 1 < text.size() && text[i + 1] == '*') {
        const std::size_t end = text.find("*/", i + 2);
        i = end == std::string::npos ? text.size() : end + 1;
      } else if (c == '\n') {
        end_line();
      } else if (c == '{' || c == '}') {
        end_line();
        lines_.push_back({std::string(1, c)});
      } else if (c == '"') {
        while (i + 1 < text.size() && text[i + 1] != '"' && text[i + 1] != '\n') word += text[++i];
        ++i;
        end_word();
      } else if (c == ' ' || c == '\t' || c == '\r') {
        end_word();
      } else {
        word += c;
      }
    }
    end_line();
  }
  const std::vector<std::vector<std::string>>& all() const { return lines_; }

 private:
  std::vector<std::vector<std::string>> lines_;
};

std::optional<Color> color_of(const std::vector<std::string>& words, std::size_t count) {
  if (words.size() < 4) return std::nullopt;
  float part[4] = {1, 1, 1, 1};
  for (std::size_t i = 0; i < count && i + 1 < words.size(); ++i) {
    const std::optional<double> number = base::parse_number(words[i + 1]);
    if (!number) return std::nullopt;
    part[i] = static_cast<float>(std::clamp(*number, 0.0, 1.0));
  }
  return Color{part[0], part[1], part[2], part[3]};
}

void apply_line(MaterialDef& material, const std::vector<std::string>& words) {
  const std::string key = base::to_lower(words[0]);
  if (key == "ambient") {
    if (auto color = color_of(words, 4)) material.ambient = *color;
  } else if (key == "diffuse") {
    if (auto color = color_of(words, 4)) material.diffuse = *color;
  } else if (key == "emissive") {
    if (auto color = color_of(words, 4)) material.emissive = *color;
  } else if (key == "specular") {
    // "r g b shininess" or "r g b a shininess".
    if (auto color = color_of(words, words.size() > 5 ? 4 : 3)) material.specular = *color;
    if (words.size() > 4) material.shininess = static_cast<float>(base::parse_number(words.back()).value_or(0));
  } else if (key == "texture" && words.size() > 1) {
    if (material.texture.empty()) material.texture = words[1];
  } else if ((key == "alpha_rejection" && words.size() > 1 && words[1] != "always_pass") ||
             (key == "scene_blend" && words.size() > 1 && words[1] != "replace" && words[1] != "one")) {
    material.has_alpha_texture = true;
  } else if (key == "scale" && words.size() > 2) {
    const double u = base::parse_number(words[1]).value_or(1), v = base::parse_number(words[2]).value_or(1);
    if (std::abs(u) > 1e-9 && std::abs(v) > 1e-9) material.texture_scale = Eigen::Vector2d(1 / u, 1 / v);
  } else if (key == "lighting" && words.size() > 1) {
    material.lighting = words[1] != "off";
  } else if (key == "cull_hardware" && words.size() > 1) {
    material.double_sided = words[1] == "none";
  }
}

}  // namespace

namespace {

constexpr std::size_t max_ancestors = 32;

struct ScriptBlock {
  std::string parent;                                  // may be empty
  std::vector<const std::vector<std::string>*> lines;  // of the first pass
};

std::map<std::string, ScriptBlock> blocks_of(const ScriptLines& lines) {
  std::map<std::string, ScriptBlock> blocks;
  ScriptBlock* current = nullptr;
  int depth = 0, passes = 0;
  for (const std::vector<std::string>& words : lines.all()) {
    if (words[0] == "{") {
      ++depth;
    } else if (words[0] == "}") {
      if (--depth <= 0) current = nullptr, depth = 0;
    } else if (depth == 0) {
      current = nullptr;
      if (words[0] != "material" || words.size() < 2) continue;
      current = &(blocks[words[1]] = {});
      const auto colon = std::find(words.begin(), words.end(), ":");
      if (colon != words.end() && colon + 1 != words.end()) current->parent = *(colon + 1);
      passes = 0;
    } else if (current) {
      passes += words[0] == "pass" ? 1 : 0;
      if (passes <= 1) current->lines.push_back(&words);
    }
  }
  return blocks;
}

}  // namespace

std::map<std::string, MaterialDef> parse_material_script(const std::string& text, std::map<std::string, std::string>* faults) {
  const ScriptLines lines(text);
  const std::map<std::string, ScriptBlock> blocks = blocks_of(lines);
  std::map<std::string, MaterialDef> materials;
  for (const auto& start : blocks) {
    std::vector<const std::pair<const std::string, ScriptBlock>*> line;  // of descent, the youngest first
    const auto is_in_line = [&](const auto* block) { return std::find(line.begin(), line.end(), block) != line.end(); };
    MaterialDef material = plain(grey(1), grey(0));
    material.has_alpha_texture = false;
    for (const auto* at = &start; at;) {
      line.push_back(at);
      const std::string& parent = at->second.parent;
      const auto next = blocks.find(parent);
      at = parent.empty() || next == blocks.end() ? nullptr : &*next;
      if (!parent.empty() && !at) material = built_in_material(parent).value_or(material);
      if (!is_in_line(at) && line.size() < max_ancestors) continue;
      if (at && faults) {
        (*faults)[start.first] = is_in_line(at) ? "inherits from itself through " + base::in_quotes(line.back()->first)
                                                : "inherits over more than " + std::to_string(max_ancestors) + " generations";
      }
      break;
    }
    for (auto block = line.rbegin(); block != line.rend(); ++block) {
      // The first texture of the nearest of kin counts.
      std::string inherited = std::exchange(material.texture, {});
      for (const auto* words : (*block)->second.lines) apply_line(material, *words);
      if (material.texture.empty()) material.texture = std::move(inherited);
    }
    material.script = start.first;
    materials.emplace(start.first, std::move(material));
  }
  return materials;
}

namespace {

// "#rrggbb" of what a name speaks of; empty if it speaks of nothing known.
std::string_view color_like(std::string_view any_case_name) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 29> colors{{
      {"grass", "#47692a"},       {"dirt", "#6b5237"},    {"fungus", "#55602e"},   {"rock", "#73706a"},     {"brick", "#8c4d3d"},
      {"wood", "#8c6138"},        {"pallet", "#997548"},  {"ceiling", "#d9d6cc"},  {"road", "#4d4d4d"},     {"asphalt", "#4d4d4d"},
      {"tarmac", "#4d4d4d"},      {"runway", "#545454"},  {"motorway", "#4d4d4d"}, {"primary", "#575757"},  {"secondary", "#5c5c5c"},
      {"residential", "#616161"}, {"paint", "#dbd6c2"},   {"cloud", "#99b3d9"},    {"steel", "#8c8c8c"},    {"rust", "#6b4d38"},
      {"sand", "#c2b280"},        {"granite", "#7d7873"}, {"marble", "#d6d3cc"},   {"concrete", "#8f8d88"}, {"carpet", "#7a6a5c"},
      {"tile", "#c9c5ba"},        {"wall", "#dbd6c2"},    {"metal", "#8c8c8c"},    {"glass", "#b5c7cf"},
  }};
  const std::string name = base::to_lower(any_case_name);
  const auto like =
      std::find_if(colors.begin(), colors.end(), [&](const auto& entry) { return name.find(entry.first) != std::string::npos; });
  return like == colors.end() ? std::string_view() : like->second;
}

// A plain colour for a material whose script is not here ("Kitchen/WoodFloor").
std::optional<MaterialDef> material_like(const std::string& name) {
  const std::string_view color = color_like(name);
  if (color.empty()) return std::nullopt;
  const auto part = [&](std::size_t at) { return static_cast<float>(std::stoul(std::string(color.substr(at, 2)), nullptr, 16)) / 255.0F; };
  return plain({part(1), part(3), part(5), 1});
}

}  // namespace

std::string color_of_media(std::string_view uri) {
  const std::string name = base::to_lower(uri);
  if (name.find("media/materials/textures/") == std::string::npos) return {};
  const std::string_view like = color_like(name);
  return std::string(color_file).append(like.empty() ? "#9a9a9a" : like);
}

Materials::Materials(const ModelPath& model_path, Complaints& complaints) : model_path_(model_path), complaints_(complaints) {}

const std::map<std::string, MaterialDef>& Materials::script_file(const std::string& path) {
  const auto known = scripts_.find(path);
  if (known != scripts_.end()) return known->second;
  std::map<std::string, MaterialDef>& materials = scripts_[path];
  std::error_code problem;
  std::vector<fs::path> files;
  if (fs::is_directory(path, problem)) {
    for (fs::directory_iterator at(path, problem), end; !problem && at != end; at.increment(problem)) {
      if (at->path().extension() == ".material") files.push_back(at->path());
    }
    std::sort(files.begin(), files.end());
  } else {
    files.emplace_back(path);
  }
  for (const fs::path& file : files) {
    base::Result<std::string> text = read_file(file);
    if (!text) {
      complaints_.add(Finding::Severity::warning, {}, text.error().message);
      continue;
    }
    for (auto& [name, material] : parse_material_script(*text, &faults_)) {
      // Textures are named without a folder: they lie beside the script or in the "textures" folder next to its own.
      if (!material.texture.empty()) {
        for (const fs::path& folder :
             {file.parent_path(), file.parent_path().parent_path() / "textures", file.parent_path() / "textures"}) {
          if (fs::is_regular_file(folder / material.texture, problem)) {
            material.texture = (folder / material.texture).lexically_normal().string();
            break;
          }
        }
      }
      materials.emplace(name, material);
    }
  }
  return materials;
}

std::optional<MaterialDef> Materials::from_script(pugi::xml_node script, const std::string& name) {
  for (pugi::xml_node uri : script.children("uri")) {
    const auto& materials = script_file(text_of(uri));
    const auto found = materials.find(name);
    if (found == materials.end()) continue;
    if (const auto fault = faults_.extract(name)) complaints_.warn(script, "material " + base::in_quotes(name) + " " + fault.mapped());
    MaterialDef material = found->second;
    if (material.texture.empty() || material.texture.front() == '/') return material;
    std::error_code problem;
    for (pugi::xml_node folder : script.children("uri")) {
      const fs::path candidate = fs::path(text_of(folder)) / material.texture;
      if (fs::is_regular_file(candidate, problem)) {
        material.texture = candidate.lexically_normal().string();
        return material;
      }
    }
    complaints_.warn(script, "texture " + base::in_quotes(material.texture) + " of material " + base::in_quotes(name) +
                                 " is not found; a chequer stands in");
    material.texture = missing_file;
    return material;
  }
  return built_in_material(name);
}

MaterialDef Materials::read(pugi::xml_node node) {
  MaterialDef material;
  const pugi::xml_node script = node.child("script");
  std::string name = text_of(script.child("name"));
  if (name.empty()) name = text_of(script);
  bool has_script = false;
  if (!name.empty() && name != "__default__") {
    if (const std::optional<MaterialDef> found = from_script(script, name)) {
      material = *found;
      has_script = true;
    } else {
      const std::optional<MaterialDef> like = material_like(name);
      complaints_.warn(node, "material " + base::in_quotes(name) + " is not known; " + (like ? "a plain colour" : "grey") + " is taken");
      material = like.value_or(material);
    }
  }
  if (!has_script && (node.child("ambient") || node.child("diffuse"))) {
    // A colour that is given stands for the one that is not.
    const Color given = color_at(node, "diffuse", color_at(node, "ambient", material.diffuse));
    material.ambient = material.diffuse = given;
  }
  material.ambient = color_at(node, "ambient", material.ambient);
  material.diffuse = color_at(node, "diffuse", material.diffuse);
  material.specular = color_at(node, "specular", material.specular);
  material.emissive = color_at(node, "emissive", material.emissive);
  material.shininess = static_cast<float>(number_at(node, "shininess", material.shininess));
  material.lighting = bool_at(node, "lighting", material.lighting);
  material.double_sided = bool_at(node, "double_sided", material.double_sided);
  if (const std::string normal = text_at(node, "shader/normal_map"); normal != "__default__") material.normal_map = normal;
  const pugi::xml_node pbr = node.child("pbr");
  for (const char* flow : {"specular", "metal"}) {
    const pugi::xml_node way = pbr.child(flow);
    if (!way) continue;
    material.has_pbr = true;
    material.texture = text_at(way, "albedo_map", material.texture);
    material.normal_map = text_at(way, "normal_map", material.normal_map);
    material.emissive_map = text_at(way, "emissive_map", material.emissive_map);
    material.metalness = static_cast<float>(number_at(way, "metalness", 0));
    material.roughness = static_cast<float>(number_at(way, "roughness", 0.5));
    if (!material.texture.empty() && !node.child("diffuse")) material.diffuse = material.ambient = grey(1);
  }
  return material;
}

}  // namespace sim
