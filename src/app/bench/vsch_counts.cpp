// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// VSCH: memory by buffer (table 1) and how many photons samples read (figure 7).
#include "app/bench/vsch_parts.h"
#include "render/cpu_frame.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace isophote::bench {
namespace {

Stats statsOfFrame(Context& context, const VschScene& scene, RenderSettings settings) {
  settings.frame.layers = false;
  Stats stats;
  renderCpu(*scene.trace, scene.camera(), settings, stats, context.job());
  return stats;
}

/// A row of table 1: what the paper's buffer takes [MiB], and ours that do its work.
struct Buffer {
  const char* name;
  const char* ours;                    ///< After the stage's name and a dot; separated by commas.
  double tiled, cluster, directional;  ///< NaN: none.
};
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kBuffers{
    Buffer{"tiles' bounds; hierarchy, bounds, normal cones", "tree,patches", 0.016, 97 + 256 + 24, 97 + 256},
    Buffer{"accumulated flux", "flux", kNone, 73, 582},
    Buffer{"jobs, lists of photons", "lists", 28, 2.4 + 60, 2.4},
    Buffer{"photons, unpacked", "photons", kNone, kNone, kNone},
};

double mebibytes(const nlohmann::json& bytes, const std::string& stage, const std::string& names) {
  double sum = 0;
  for (std::size_t at = 0; at < names.size();) {
    const std::size_t end = std::min(names.find(',', at), names.size());
    const std::string key = stage + "." + names.substr(at, end - at);
    if (bytes.contains(key)) sum += bytes[key].get<double>();
    at = end + 1;
  }
  return sum / double(1 << 20);
}

Cell orEmpty(double value) { return std::isnan(value) ? Cell() : Cell(value); }

/// A frame of the few photons by one method.
struct Counted {
  VschMethod method;
  const char* stage;
  Stats stats = {};
  nlohmann::json bytes = {};  ///< Of the stats.
};
constexpr std::array<std::size_t, 3> kOfTable1{0, 3, 4};

void addMemoryRows(std::span<const Counted* const> memories, Table& table) {
  std::array<double, 3> paper{0.16, 0.16, 0.16}, ours{};
  for (const Buffer& buffer : kBuffers) {
    std::vector<Cell> row{buffer.name};
    const std::array printed{buffer.tiled, buffer.cluster, buffer.directional};
    for (std::size_t i = 0; i < memories.size(); ++i) {
      const double here = mebibytes(memories[i]->bytes, memories[i]->stage, buffer.ours);
      row.insert(row.end(), {orEmpty(printed[i]), here});
      paper[i] += std::isnan(printed[i]) ? 0.0 : printed[i];
      ours[i] += here;
    }
    table.rows.push_back(std::move(row));
  }
  std::vector<Cell> map{"photon map"}, blur{"pixels of the blur (the paper's are not printed)"}, all{"all"};
  for (std::size_t i = 0; i < memories.size(); ++i) {
    const double photons = mebibytes(memories[i]->bytes, "photon_trace", "photons");
    const double pixels = mebibytes(memories[i]->bytes, "irradiance_blur", "pixels");
    map.insert(map.end(), {0.16, photons});
    blur.insert(blur.end(), {Cell(), pixels});
    all.insert(all.end(), {paper[i], ours[i] + photons + pixels});
  }
  table.rows.insert(table.rows.end(), {std::move(map), std::move(blur), std::move(all)});
}

void addMemory(Context& context, const VschScene& scene, std::span<const Counted> counted) {
  std::array<const Counted*, kOfTable1.size()> memories{};
  for (std::size_t i = 0; i < memories.size(); ++i) memories[i] = &counted[kOfTable1[i]];
  const RenderSettings shown = vschSettings(context, VschMethod::kTiled, kVschFew);
  Table table{
      .id = "table1",
      .title = "Table 1: memory",
      .caption = fmt::format(
          "{}, {} x {}, {} photons of radius {:.3g}; the paper's at 1920 x 1080 with {} of radius {}. "
          "The paper keeps a dense hierarchy, we the nodes that there are; lists of photons within "
          "subtrees live as long as the subtree is worked on and do not count. A photon of the map takes {} "
          "bytes here, 17 in the paper: position and RGB power are floats, and it keeps the normal and the "
          "path density, which other estimators ask for.",
          scene.choice.name, shown.frame.width, shown.frame.height, shown.photonTrace.photonsStored,
          shown.photonTiles.radius, kVschFew.photons, kVschFew.radius, sizeof(Photon)),
      .columns = {{"buffer"}}};
  for (const Counted* memory : memories)
    for (const Source source : {Source::kPaper, Source::kHere})
      table.columns.push_back({nameOf(memory->method), source, "MiB"});
  addMemoryRows(memories, table);
  context.add(std::move(table));
}

void addReads(Context& context, const VschScene& scene, std::span<const Counted> counted) {
  Table table{
      .id = "figure7",
      .title = "Figure 7: photons that view samples read",
      .caption = fmt::format(
          "{}, {} photons of radius {} in the paper, whose bars have no figures; its text says that "
          "less than 3 % of what clusters read is rejected by the distance. Of \"directional\" a pair is "
          "one of a cluster, not of a view sample, and a photon.",
          scene.choice.name, kVschFew.photons, kVschFew.radius),
      .columns = {{"method"},
                  {"read", Source::kHere, "M"},
                  {"at a sample", Source::kHere},
                  {"rejected", Source::kPaper, "%"},
                  {"rejected", Source::kHere, "%"},
                  {"contributing, from lists", Source::kHere, "M"},
                  {"contributing, by nodes", Source::kHere, "M"},
                  {"nodes", Source::kHere}}};
  Plot plot{.id = "figure7",
            .title = table.title,
            .caption = "Contributing are those that tiles find.",
            .x = {""},
            .y = {"photons read [M]"},
            .series = {{.name = "read"}}};
  const auto addBar = [&](const char* name, double value) {
    plot.series[0].points.emplace_back(double(plot.categories.size()), value);
    plot.categories.emplace_back(name);
  };
  for (const Counted& frame : counted) {
    const bool lists = frame.method == VschMethod::kCluster || frame.method == VschMethod::kClusterCone ||
                       frame.method == VschMethod::kClusterTrivial;
    const auto counter = [&](const char* name) {
      return frame.stats.counter(fmt::format("{}.{}", frame.stage, name));
    };
    const double read = counter("pairsTested"), felt = counter("pairsContributing");
    const bool directional = frame.method == VschMethod::kDirectional;
    const double rejected = directional ? read - felt : counter("pairsRejected");
    double nodes = 0;
    for (const double level : frame.stats.counterList(fmt::format("{}.nodes", frame.stage))) nodes += level;
    table.rows.push_back({nameOf(frame.method), read / 1e6,
                          read / std::max(frame.stats.counter("gbuffer.viewSamples"), 1.0),
                          lists ? Cell(3.0) : Cell(), 100 * rejected / std::max(read, 1.0), felt / 1e6,
                          counter("pairsAccepted") / 1e6, nodes});
    addBar(nameOf(frame.method), read / 1e6);
  }
  addBar("contributing", counted.front().stats.counter("photon_tiles.pairsContributing") / 1e6);
  context.add(std::move(table));
  context.add(std::move(plot));
}

}  // namespace

void benchVschCounts(Context& context, VschScenes& scenes) {
  if (!context.hasTimeFor("table 1 and figure 7", 3)) return;
  const VschScene& scene = scenes[PublicScene::kSponzaCrytek];
  std::array<Counted, 5> counted{{{VschMethod::kTiled, "photon_tiles"},
                                  {VschMethod::kCluster, "photon_clusters"},
                                  {VschMethod::kClusterCone, "photon_clusters"},
                                  {VschMethod::kClusterTrivial, "photon_clusters"},
                                  {VschMethod::kDirectional, "photon_directional"}}};
  for (Counted& frame : counted) {
    frame.stats = statsOfFrame(context, scene, vschSettings(context, frame.method, kVschFew));
    frame.bytes = nlohmann::json::parse(frame.stats.toJson())["bytes"];
  }
  addMemory(context, scene, counted);
  addReads(context, scene, counted);
}

}  // namespace isophote::bench
