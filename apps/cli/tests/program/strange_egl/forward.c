/* A libEGL that forwards all calls to the library at the path REAL. Only the lists of extensions are its own: CLIENT
   lists the client extensions, DISPLAY those of a display. */
#include <dlfcn.h>
#include <stddef.h>

static void *function(const char *name) {
    static void *real;
    if (!real) real = dlopen(REAL, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    return dlsym(real, name);
}

#define FORWARD(result, name, parameters, arguments) \
    result name parameters { return ((result(*) parameters)function(#name)) arguments; }

typedef void *P;
typedef int I;
FORWARD(unsigned, eglBindAPI, (unsigned a), (a))
FORWARD(unsigned, eglChooseConfig, (P a, P b, P c, I d, P e), (a, b, c, d, e))
FORWARD(P, eglCreateContext, (P a, P b, P c, P d), (a, b, c, d))
FORWARD(P, eglCreatePbufferSurface, (P a, P b, P c), (a, b, c))
FORWARD(P, eglCreateWindowSurface, (P a, P b, P c, P d), (a, b, c, d))
FORWARD(unsigned, eglGetConfigAttrib, (P a, P b, I c, P d), (a, b, c, d))
FORWARD(unsigned, eglGetConfigs, (P a, P b, I c, P d), (a, b, c, d))
FORWARD(unsigned, eglQuerySurface, (P a, P b, I c, P d), (a, b, c, d))
FORWARD(unsigned, eglSwapBuffers, (P a, P b), (a, b))
FORWARD(unsigned, eglSwapInterval, (P a, I b), (a, b))
FORWARD(unsigned, eglDestroyContext, (P a, P b), (a, b))
FORWARD(unsigned, eglDestroySurface, (P a, P b), (a, b))
FORWARD(P, eglGetCurrentContext, (void), ())
FORWARD(P, eglGetCurrentDisplay, (void), ())
FORWARD(P, eglGetCurrentSurface, (I a), (a))
FORWARD(P, eglGetDisplay, (P a), (a))
FORWARD(I, eglGetError, (void), ())
FORWARD(P, eglGetProcAddress, (P a), (a))
FORWARD(unsigned, eglInitialize, (P a, P b, P c), (a, b, c))
FORWARD(unsigned, eglMakeCurrent, (P a, P b, P c, P d), (a, b, c, d))
FORWARD(unsigned, eglQueryAPI, (void), ())
FORWARD(unsigned, eglTerminate, (P a), (a))

const char *eglQueryString(P display, I name) {
    if (name == 0x3055) return display ? DISPLAY : CLIENT;
    return ((const char *(*)(P, I))function("eglQueryString"))(display, name);
}
