#![no_main]

echomarch_fuzz::program!(sofa);
