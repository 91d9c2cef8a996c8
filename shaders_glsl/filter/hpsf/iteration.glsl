// Path space filtering of its own result: the iterated weighted averages of Keller et al. 2014 (Meijer, section 3.4, figure 4), in hashed cells.
//
// With hpsf.iterations, the radiance behind the filter vertex that collect, merge and resolve have made of each pixel, a mean of many samples, is
// the pixel's sample once more, one as good as the other, under another jitter. Box and jitter are convolved with themselves: the kernel is
// smoother, and its variance n times as large after n filterings, where that of a cell of twice the width is four times as large. Without jitter,
// nothing changes. Only the first filtering has a history: the others have keys and cells that are cleared, and what they make enters no cell of
// the next frame.
//
// Deviations and why: the thesis thinks of storing a sample under several jitters (section 7). That takes jitter's noise out of the one filtering,
// as hpsf.lookups does where cells are read, and makes it no wider. The limit on samples (hpsf.limit) and the split of coarse cells
// (hpsf.adaptive) are about samples' noise, which means do not have; they are the first filtering's alone.
//
// Against wider cells (cornell, 96x54, four seeds; FLIP, relMSE, and the table's passes as a multiple of those at 8 pixels):
//   one frame, 4 pixels, once, twice, three times: 0.097 and 0.0205; 0.098 and 0.0116, 2 times; 0.103 and 0.0103, 3 times.
//   8 pixels once: 0.111 and 0.0182; 4 pixels with four lookups: 0.092 and 0.0109, 1.5 times; with one pass of hpsf.smooth 0.092 and 0.0069.
//   16 frames, the same: 0.049 and 0.0048; 0.069 and 0.0066, 2.4 times; 0.084 and 0.0073, 4 times; 8 pixels 0.069 and 0.0077; four
//   lookups 0.043 and 0.0022; smooth 0.049 and 0.0020.
// Twice in cells of 4 pixels is better than once in cells of 8, and takes twice the time; what else that time buys, lookups or smoothing, is better
// than both. Where little but noise is to be seen (material, one frame, same order, relMSE without the worst 0.1 % of the pixels): 0.340 and 0.43;
// 0.290 and 0.25; 0.269 and 0.21; 0.315 and 0.36; 0.326 and 0.30; 0.315 and 0.24; there 16 pixels once do as well at once: 0.261 and 0.24.
// hpsf+ (three seeds) goes from 0.0783 and 0.0066 to 0.0785 and 0.0066 on cornell, 0.260 and 0.21 to 0.242 and 0.20 on material; after 16
// frames from 0.0379 and 0.00080 to 0.0400 and 0.00089, 0.124 and 0.038 to 0.120 and 0.039: the default is once.
#ifndef FILTER_HPSF_ITERATION_GLSL
#define FILTER_HPSF_ITERATION_GLSL

/// How often what is filtered has been filtered before.
layout(constant_id = 235) const uint ITERATION = 0;

#endif
