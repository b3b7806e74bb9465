#ifndef DIMINISH_C_H
#define DIMINISH_C_H

/* diminish for C, and for every language that can call C: C99, no exceptions, plain structs.
 *
 * A function that can fail returns a diminish_status. diminish_last_error() has the line that the
 * program would print, for the calling thread. Pictures are 8 bits a channel, BGR; masks and
 * provenance one byte a pixel; depths 16 bits, in the rig's unit, 0 where nothing was measured. */

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define DIMINISH_C_API __attribute__((visibility("default")))
#else
#define DIMINISH_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum diminish_status {
  DIMINISH_OK = 0,
  DIMINISH_CONFIGURATION = 1, /* rig.yaml, scene.yaml, options, arguments */
  DIMINISH_INPUT = 2,         /* images and other data that are wrong */
  DIMINISH_DEVICE = 3,        /* a camera or GPU that is missing or fails */
  DIMINISH_IO = 4,            /* a file or folder that cannot be read or written */
  DIMINISH_INTERNAL = 5       /* a bug in the library, or no memory */
} diminish_status;

/* A set-up's pipeline. One thread at a time may use it. */
typedef struct diminish_pipeline diminish_pipeline;

/* Pixels that belong to the caller: rows from top to bottom, stride bytes apart. data 0: none. */
typedef struct diminish_image {
  const void* data;
  int32_t width, height;
  ptrdiff_t stride;
} diminish_image;

typedef struct diminish_rgbd {
  diminish_image color; /* 3 bytes a pixel */
  diminish_image depth; /* 2 bytes a pixel */
} diminish_rgbd;

/* What the cameras saw at one moment. */
typedef struct diminish_input {
  diminish_image color;      /* the user's view: 3 bytes a pixel */
  const diminish_rgbd* rgbd; /* one for each RGB-D camera, in the rig's order; without data: none */
  size_t rgbd_count;
  double stamp_s; /* grows from frame to frame */
} diminish_input;

/* Views of the pipeline's memory, until its next call. */
typedef struct diminish_output {
  diminish_image picture;    /* without the objects: 3 bytes a pixel */
  diminish_image mask;       /* 255 where pixels were replaced */
  diminish_image provenance; /* 0 the camera; 1 to 199 an RGB-D camera; 200 witnessed, 201
                                remembered, 202 part of a bar without depth; 254 invented; 255
                                unknown */
  /* Parts of bars count as invented: their colours are. */
  uint64_t mask_pixels, seen_pixels, remembered_pixels, invented_pixels;
  double milliseconds;
  const char* messages; /* what could not be done, a line each; empty: nothing */
} diminish_output;

/* Such as "0.2.0" */
DIMINISH_C_API const char* diminish_version(void);

/* Of the calling thread's last call that failed; one line, until its next. */
DIMINISH_C_API const char* diminish_last_error(void);

/* Makes the pipeline of a folder with rig.yaml and scene.yaml. */
DIMINISH_C_API diminish_status diminish_open(const char* folder, diminish_pipeline** pipeline);

/* How many RGB-D cameras the rig has, those without depth among them, and their names, in its
 * order; null beyond the last. The name stays until the pipeline is closed. */
DIMINISH_C_API size_t diminish_rgbd_count(const diminish_pipeline* pipeline);
DIMINISH_C_API const char* diminish_rgbd_name(const diminish_pipeline* pipeline, size_t index);

/* Removes what this detector finds, such as "difference", instead of the objects in scene.yaml.
 * Forgets what was seen before. */
DIMINISH_C_API diminish_status diminish_set_detector(diminish_pipeline* pipeline,
                                                     const char* detector);

/* Sets an option, as on the command line: ("memory", "off"), ("mask_margin_px", "7"),
 * ("smooth_depth", "false"). Takes effect with the next frame. */
DIMINISH_C_API diminish_status diminish_set_option(diminish_pipeline* pipeline, const char* name,
                                                   const char* value);

/* What a camera delivers is no error: it is in the output's messages. */
DIMINISH_C_API diminish_status diminish_process(diminish_pipeline* pipeline,
                                                const diminish_input* input,
                                                diminish_output* output);

/* Reads the next frame of the folder's recording and processes it. *more is 0 after the last one,
 * and output is unchanged. */
DIMINISH_C_API diminish_status diminish_next(diminish_pipeline* pipeline, diminish_output* output,
                                             int* more);

/* A null pointer is fine. */
DIMINISH_C_API void diminish_close(diminish_pipeline* pipeline);

#ifdef __cplusplus
}
#endif

#endif
