// What work on patches, on TetraQuad surfaces and on tiles needs of memory, beside needs.h and measured in the same
// way.
#pragma once

#include <string>
#include <vector>

#include "retalho/patch/patch.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho::app {

/// Patches in memory with their surfaces, and `more`. Throws BadInput where that passes the memory limit.
void check_patches_need(const std::string& work, const std::vector<Patch>& patches, double more,
                        const std::string& file);
/// The same before they are made: `nodes` of them.
void check_nodes_need(const std::string& work, double nodes, Recovery recovery, const std::string& file);
/// A TetraQuad surface: bytes a tetrahedron, the model's own included, and `more`.
void check_tetraquad_need(const std::string& work, const TetraQuad& surface, double a_tetrahedron, double more,
                          const std::string& file);
/// Any model as the page takes it, points or a grid: what reading them needs.
void check_shown_need(const std::string& file);
/// Tiles of `side` x `side` cells of a grid, `jobs` of them at a time.
void check_tiles_need(double side, int jobs, const std::string& file);

// Bytes.
inline constexpr double kPatchDrawn = 6e6;         ///< a patch, cut finely for a picture
inline constexpr double kPixelDrawn = 6;           ///< the panels and the sheet that they are put on
inline constexpr double kTetrahedronDrawn = 1200;  ///< rays into a TetraQuad
inline constexpr double kCurveFile = 80;           ///< a byte of a file of curves
inline constexpr double kMeshFile = 12;            ///< a byte of a mesh that gets parameters; its surface comes on top
inline constexpr double kTetrahedronMeshed = 600;  ///< its mesh; 95 a triangle come on top, which is not known before

}  // namespace retalho::app
