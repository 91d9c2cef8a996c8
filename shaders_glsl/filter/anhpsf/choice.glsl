// Which of two vertices a pixel goes on from, by what cells have learned: the last idea of Meijer, section 7.
//
// With anhpsf.choice = importance a path that has come to a new vertex and the path that waits at the end of this frame's list are both
// candidates for the frame's shadow ray and the next one's scattered ray. Which one goes on is drawn with a chance in proportion to what
// another sample is worth to their cells: with n samples, mean m, and the attenuation a on the way to the vertex before, a sample more
// takes a m / (n + 1) of what is sent on off the standard error, if a sample's deviation is m (filter/hpsf/forgetting.glsl). So
// bright cells, that pass much on, of few samples, win over those that are dark or known.
//
// Nothing is divided by the chance. The choice falls before any light is looked for at either vertex, and depends on where they are and on
// what cells knew before: given those, each sample that enters a cell is as good as without a choice, and a cell's mean over them stays
// the mean over places of the cell. How many come to it depends on the earlier ones, by which means of few samples are biased as those
// of any adaptive sampling are; chances keep away from 0 and 1, so that no cell starves, and the bias goes with the number of samples:
// consistent, as the deepest-first form is. A choice between two rays that have been scattered already would not be: a vertex where
// roulette has ended the path is complete, and one where the path goes on would be dropped, with the light that makes up for it.
//
// A vertex that gives way is only looked up. It stays where its cell knows nothing, and gives way for certain where the path is as deep as
// paths.max_bounces. Where the path has ended, the other one sets out in the same frame, whose shadow ray it would else leave unused.
// Between all vertices of a path (anhpsf.transport = all) the choice would fall by where a path has got to, after its first vertices
// have been sent again: those of some paths would be sent more often than others. There, the deepest path goes on.
//
// Measured (assets/suites/papers.md): on cornell next to nothing, since nearly all cells are in the picture and known.
//
// Deviations and why: the thesis thinks of learning which cells are seen from which; what is learned here is what cells know anyway.
#ifndef FILTER_ANHPSF_CHOICE_GLSL
#define FILTER_ANHPSF_CHOICE_GLSL

#include "filter/anhpsf/chain.glsl"
#include "filter/hpsf/table.glsl"
#include "lib/colour.glsl"

const uint CHOICE_IMPORTANCE = 1u;
const bool CHOOSES = ANHPSF_CHOICE == CHOICE_IMPORTANCE && ANHPSF_TRANSPORT != TRANSPORT_ALL;

const float LEAST_CHANCE = 0.05;

/// What another sample takes off the standard error of what a cell's radiance adds to the vertex before.
float worth_of_sample(Cell cell, vec3 attenuation) {
    return luminance(attenuation * cell.mean) / (float(cell.count) + 1.0);
}

/// Chance that a path at a vertex of cell `own` gives way to one of cell `other`, which is taken to be as bright where it is unknown.
float chance_to_give_way(Cell own, vec3 own_attenuation, Cell other, vec3 other_attenuation) {
    if (other.count == 0u) {
        other.mean = own.mean;
    }
    float worth = worth_of_sample(other, other_attenuation);
    float both = worth + worth_of_sample(own, own_attenuation);
    return both > 0.0 ? clamp(worth / both, LEAST_CHANCE, 1.0 - LEAST_CHANCE) : 0.5;
}

#endif
