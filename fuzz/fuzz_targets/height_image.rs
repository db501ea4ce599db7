#![no_main]

echomarch_fuzz::program!(height_image);
