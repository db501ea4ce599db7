#![no_main]

echomarch_fuzz::program!(base_scene);
