/* diminish from C.   c_example RECORDING: processes its frames, prints what was found. */
#include <stdio.h>

#include "diminish_c.h"

static int failed(const char *what) {
  fprintf(stderr, "%s: %s\n", what, diminish_last_error());
  return 1;
}

int main(int argc, char **argv) {
  diminish_pipeline *pipeline = NULL;
  diminish_output output;
  int more = 1;
  int frame = 0;
  if (argc != 2) {
    fprintf(stderr, "usage: c_example RECORDING\n");
    return 2;
  }
  if (diminish_open(argv[1], &pipeline) != DIMINISH_OK) return failed("open");
  if (diminish_set_detector(pipeline, "difference") != DIMINISH_OK) return failed("detector");
  for (;; ++frame) {
    if (diminish_next(pipeline, &output, &more) != DIMINISH_OK) return failed("next");
    if (!more) break;
    printf("frame %d: %llu pixels replaced, %llu of them seen\n", frame,
           (unsigned long long)output.mask_pixels, (unsigned long long)output.seen_pixels);
  }
  diminish_close(pipeline);
  return frame > 0 ? 0 : 1;
}
