// What every layer of a picture keeps to where a test names no limits.
#pragma once

#include <string>
#include <vector>

#include "measure/common/comparable.h"

namespace trilens {

/// Pixels of a layer that may be off: rounding on another machine may move an edge.
inline constexpr double kLayerPixelsOff = 0.001;  // share of all
/// By how much a value may differ before its pixel is off.
inline constexpr double kColourOff = 0.004;    // R, G, B, A
inline constexpr double kPositionOff = 1e-4;   // X, Y, Z of a point: of the layer's largest coordinate
inline constexpr double kParameterOff = 1e-4;  // U, V
inline constexpr double kOtherOff = 1e-3;  // of the value itself: depths, lengths, all others. Ids are equal

/// The rules broken by layers that both images have, one sentence for each layer: more pixels off than
/// kLayerPixelsOff. Two values that are no number count as equal.
std::vector<std::string> broken_layers(const CommonChannels& images);

/// One sentence for each layer of which only one image has channels, with their names.
std::vector<std::string> missing_layers(const CommonChannels& images);

/// "reflectP" of "reflectP.X"; a channel without a layer is its own.
std::string layer_of(const std::string& channel);

/// "reflectP (reflectP.X, reflectP.Y)" for each layer of the channels.
std::vector<std::string> layers_of(const std::vector<std::string>& channels);

}  // namespace trilens
