# What stands before the kernels in the module that `physim.joining` makes: how arguments from Python
# are taken, scratch memory, and what `physim.natives` says in Python.

import sys

import cython
cimport numpy as cnp
from libc.math cimport *

cnp.import_array()

ctypedef long long i8
ctypedef i8 (*ints2)[2]
ctypedef double (*doubles2)[2]

# a row of `physim.contacts.CONTACT_ROW`
cdef packed struct contact_row:
    i8 step
    int a, b
    char phase, kind
    double x, y, nx, ny, depth, impulse
ctypedef contact_row* ContactRows


cdef void* numbers(object x, int kind, Py_ssize_t width, str name) except NULL:
    """Address of the numbers of an array, whose kind and width of a row are checked."""
    if not cnp.PyArray_Check(x):
        raise TypeError(f"{name} is no array but {type(x).__name__}")
    cdef cnp.ndarray a = x
    cdef int n = cnp.PyArray_NDIM(a)
    if cnp.PyArray_TYPE(a) != kind or not cnp.PyArray_ISCARRAY_RO(a) or (
        width > 1 and (n < 2 or cnp.PyArray_DIM(a, n - 1) != width)
    ):
        raise TypeError(f"{name} is an array of the wrong kind: {x.dtype}, {x.shape}")
    return cnp.PyArray_DATA(a)


cdef object named(str module, str kind, tuple values):
    """A named tuple of a module."""
    return getattr(sys.modules[module], kind)(*values)


# Scratch: arrays that a kernel makes. They are given back when it returns, but for those that it
# returns: these its caller gives back. Each thread has its own: while the engine steps in one, which
# calls kernels, others may run.
cdef extern from *:
    '''
    #include <math.h>
    #include <stdlib.h>

    typedef struct block { struct block *before; size_t size, used; } block;
    typedef struct { block *top; size_t used; } scratch_mark;
    #ifdef _MSC_VER
    static __declspec(thread) block *scratch_top = NULL;
    #else
    static __thread block *scratch_top = NULL;
    #endif

    static void *scratch(long long bytes) {
        size_t needed = ((size_t)bytes + 15) / 16 * 16;
        if (!scratch_top || scratch_top->size - scratch_top->used < needed) {
            size_t size = scratch_top ? 2 * scratch_top->size : 65536;
            if (size < needed) size = needed;
            block *more = (block *)malloc(sizeof(block) + size);
            if (!more) Py_FatalError("physim: out of memory");
            more->before = scratch_top, more->size = size, more->used = 0;
            scratch_top = more;
        }
        scratch_top->used += needed;
        return (char *)(scratch_top + 1) + scratch_top->used - needed;
    }
    static scratch_mark scratch_now(void) {
        scratch_mark now = { scratch_top, scratch_top ? scratch_top->used : 0 };
        return now;
    }
    static void scratch_back(scratch_mark to) {
        while (scratch_top != to.top && scratch_top->before) {
            block *last = scratch_top;
            scratch_top = last->before;
            free(last);
        }
        if (scratch_top) scratch_top->used = to.top ? to.used : 0;
    }
    static double *doubles(long long n) { return (double *)scratch(8 * n); }
    static long long *integers(long long n) { return (long long *)scratch(8 * n); }
    static char *flags(long long n) { return (char *)scratch(n); }
    static double *full_doubles(long long n, double value) {
        double *all = doubles(n);
        for (long long k = 0; k < n; k++) all[k] = value;
        return all;
    }
    static long long *full_integers(long long n, long long value) {
        long long *all = integers(n);
        for (long long k = 0; k < n; k++) all[k] = value;
        return all;
    }
    static char *full_flags(long long n, char value) {
        char *all = flags(n);
        for (long long k = 0; k < n; k++) all[k] = value;
        return all;
    }
    static long long *counted(long long n) {
        long long *all = integers(n);
        for (long long k = 0; k < n; k++) all[k] = k;
        return all;
    }
    '''
    ctypedef struct scratch_mark:
        pass
    const double inf "((double)INFINITY)"
    const double NaN "((double)NAN)"
    scratch_mark scratch_now() noexcept nogil
    void scratch_back(scratch_mark to) noexcept nogil
    double* doubles(i8 n) noexcept nogil
    i8* integers(i8 n) noexcept nogil
    char* flags(i8 n) noexcept nogil
    double* full_doubles(i8 n, double value) noexcept nogil
    i8* full_integers(i8 n, i8 value) noexcept nogil
    char* full_flags(i8 n, char value) noexcept nogil
    i8* counted(i8 n) noexcept nogil


cdef inline void call2(i8 function, i8 a, i8 b) noexcept nogil:
    (<void (*)(i8, i8) noexcept nogil>function)(a, b)

cdef inline void call3(i8 function, i8 a, i8 b, i8 c) noexcept nogil:
    (<void (*)(i8, i8, i8) noexcept nogil>function)(a, b, c)

cdef inline double* doubles_at(i8 place, i8 count) noexcept nogil:
    return <double*>place

cdef inline doubles2 rows2_at(i8 place, i8 count) noexcept nogil:
    return <doubles2>place

cdef inline i8* integers_at(i8 place, i8 count) noexcept nogil:
    return <i8*>place

cdef inline ints2 int_rows2_at(i8 place, i8 count) noexcept nogil:
    return <ints2>place

cdef extern from *:
    '''
    static inline unsigned long long high_product(unsigned long long a, unsigned long long b) {
    #if defined(__SIZEOF_INT128__)
        return (unsigned long long)((unsigned __int128)a * b >> 64);
    #else
        unsigned long long a0 = a & 0xFFFFFFFF, a1 = a >> 32, b0 = b & 0xFFFFFFFF, b1 = b >> 32;
        unsigned long long middle = a1 * b0 + (a0 * b0 >> 32);
        unsigned long long other = a0 * b1 + (middle & 0xFFFFFFFF);
        return a1 * b1 + (middle >> 32) + (other >> 32);
    #endif
    }
    '''
    unsigned long long high_product(unsigned long long a, unsigned long long b) noexcept nogil

cdef inline void put_short(i8 place, i8 value) noexcept nogil:
    (<int*>place)[0] = <int>value
