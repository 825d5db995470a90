// The inner loops of the software renderer, compiled for several instruction sets; the processor's
// best one is chosen at run time. All give the same bytes: no operation is contracted, approximated
// or summed in another order. Internal to render/.
//
// Method: triangles are drawn at once into a buffer of 4 x 4 pixel blocks that stores nearness and
// the id of the nearest triangle (a visibility buffer). Corners are rounded to 1/256 pixel, edge
// functions are exact, so neighbours leave no gap and share no pixel. Small triangles, nearly all
// of a robot's, are set up a register at a time. Colours are computed once for each pixel,
// afterwards.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "robocell/render/soft_frame.h"

namespace robocell::internal {

// Returns the instruction set in use, e.g. "AVX2".
std::string SoftInstructions();

// Functions with rows work on those alone: several threads may share an image.

// Makes the buffer as large as the view. What is in it is not said.
void FitBuffer(const SoftView& view, SoftBuffer* buffer);
// Makes a buffer without ids as large as the view.
void FitNearness(const SoftView& view, SoftBuffer* buffer);
// Empties the blocks that have a flag.
void ClearBlocks(const SoftView& view, std::span<const uint8_t> wanted, SoftBuffer* buffer);
// Empties the rows.
void ClearRows(const SoftView& view, SoftRows rows, SoftBuffer* buffer);

// Draws the instance into the view's rows of the buffer. One without ids gets nearness only.
void DrawInstance(const SoftView& view, const SoftInstance& instance, SoftScratch* scratch,
                  SoftBuffer* buffer);

// Computes what lies nearest and farthest in each tile of a map; rows of tiles.
void SummariseMap(SoftShadowMap* map, SoftRows rows);

// Reads metres and bodies from the buffer; either may be empty.
void ReadExact(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
               std::span<float> metres, std::span<int32_t> bodies);

// Computes the colours of the buffer: red, green, blue from the lowest byte on. `wanted` here and
// below: null, or a flag of each block; the colours of others stay as they are.
void ShadePicture(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                  const uint8_t* wanted, std::span<SoftIds> colours);
// Computes the colours into rows of 3 bytes a pixel.
void ShadePicture(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                  std::span<uint8_t> rgb);

// Finds the tiles of a map on which the colours of blocks depend: if none of them changes, the block
// has the same shadows, bit by bit.
void FindReach(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
               const uint8_t* wanted, const SoftShadow& shadow, std::span<SoftReach> reach);

// Reserves empty samples for blocks that show an edge between surfaces. The number and positions of
// a pixel's samples stay unchanged.
void FindEdges(const SoftView& view, const SoftBuffer& buffer, const uint8_t* wanted,
               SoftSamples* samples);

// Draws the instance into those of the view's rows.
void DrawSamples(const SoftView& view, const SoftInstance& instance, SoftScratch* scratch,
                 SoftSamples* samples);

// Sums the colours of the samples. All colours are read; `strays` is scratch memory.
void SumSamples(const SoftPicture& picture, const SoftBuffer& buffer, SoftRows rows,
                std::span<const SoftIds> colours, std::vector<SoftStray>* strays,
                SoftSamples* samples);
// Replaces colours at edges by the means of the samples.
void TakeMeans(const SoftSamples& samples, SoftRows rows, std::span<SoftIds> colours);

// Blends an instance that can be seen through over the colours, in front of what is in the buffer.
// Its nearness and ids are in `layer`.
void BlendLayer(const SoftPicture& picture, const SoftBuffer& behind, const SoftBuffer& layer,
                SoftRows rows, float alpha, std::span<SoftIds> colours);

// Packs colours into rows of 3 bytes a pixel.
void PackColours(const SoftBuffer& buffer, SoftRows rows, std::span<const SoftIds> colours,
                 std::span<uint8_t> rgb);

}  // namespace robocell::internal
