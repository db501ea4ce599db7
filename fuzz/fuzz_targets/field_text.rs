#![no_main]

echomarch_fuzz::program!(field_text);
